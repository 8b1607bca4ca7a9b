#pragma once

#include <gnomon/light.h>
#include <gnomon/scene.h>

#include <string_view>

/// Cameras and lights from the text of --camera and --light.
namespace gnomon::cli {

/// From the coordinates that a scene's file is written in to the scene's own, which are Y up and
/// near the origin.
struct FileFrame {
    DVec3 origin_offset_m{0.0};  ///< Scene::origin_offset_m()
    bool z_up = false;           ///< the file's third axis points up

    /// Subtracts the offset in double, because float cannot hold a city's coordinates.
    Vec3 point(DVec3 file_m) const;
    DVec3 direction(DVec3 file) const;
    /// The point back in the file's coordinates.
    DVec3 file_point_m(Vec3 point_ws) const;
};

/// The light of "sun:elevation=35,azimuth=120", "point:position=x,y,z" and so on, validated.
/// Throws Error{input}.
Light parse_light(std::string_view text, const FileFrame& frame = {});

/// Is `text` a camera of its own ("eye=..,target=.."), not the name of one?
bool is_camera_pose(std::string_view text);

/// The camera of "eye=x,y,z,target=x,y,z,fov=45,near=0.1", validated; fov (degrees of the height)
/// and near (metres) may be left out. Throws Error{input}.
Camera parse_camera(std::string_view text, const FileFrame& frame = {});

}  // namespace gnomon::cli
