#pragma once

#include <gnomon/scene.h>

#include "scene/load_context.h"

#include <vector>

namespace gnomon::scene {

/// Makes a mesh straight from a file fit for a Scene: leaves out triangles that name vertices that
/// are not there or lie nowhere, scales normals to unit length, replaces those that are none by the
/// geometric normal, and puts defaults for what is not finite in the other streams.
void repair_mesh(Mesh& mesh, Warnings& warnings);

/// Area-weighted mean of the geometric normals of the triangles at each vertex; (0, 1, 0) where
/// there are none.
std::vector<Vec3> geometric_normals(const Mesh& mesh);

}  // namespace gnomon::scene
