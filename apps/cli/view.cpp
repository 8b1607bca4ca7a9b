#include "view.h"

#include "fail.h"
#include "parse.h"

#include <array>
#include <functional>

namespace gnomon::cli {

namespace {

constexpr std::string_view kLightFlag = "--light";
constexpr std::string_view kCameraFlag = "--camera";
// Far beyond any map projection's coordinates, and float still squares it.
constexpr double kMaxCoordinateM = 1e9;
constexpr Range kCoordinate{-kMaxCoordinateM, kMaxCoordinateM, "metres"};
constexpr Range kDirection{-kMaxCoordinateM, kMaxCoordinateM, ""};
constexpr Range kLength{1e-6, kMaxCoordinateM, "metres"};
constexpr Range kStrength{0.0, 1e9, ""};
constexpr Range kElevation{-90.0, 90.0, "degrees"};
constexpr Range kAzimuth{-360.0, 360.0, "degrees"};
constexpr Range kDiameter{0.0, 90.0, "degrees"};
constexpr Range kSpotAngle{0.0, 90.0, "degrees"};
constexpr Range kFov{0.1, 179.0, "degrees"};
constexpr double kDefaultFovDeg = 45.0;
// Cosine of the greatest departure from a right angle that may be a rounding of the user's numbers.
constexpr double kRightAngleTolerance = 1e-3;

float radians_of(double degrees_value) {
    return radians(static_cast<float>(degrees_value));
}

Vec3 unit_direction(const KeyValues& keys, std::string_view key, const FileFrame& frame) {
    const DVec3 direction = frame.direction(keys.vector(key, kDirection));
    const double length = glm::length(direction);
    if (length == 0.0) fail_usage("{}: 0,0,0 has no direction", keys.label(key));
    return Vec3(direction / length);
}

Light parse_sun(const KeyValues& keys, const FileFrame&) {
    DirectionalLight light =
        sun(radians_of(keys.number("elevation", kElevation, 0.0)),
            radians_of(keys.number("azimuth", kAzimuth, 0.0)),
            radians_of(keys.number("diameter", kDiameter, degrees(kSunAngularDiameterRad))));
    light.irradiance = keys.color("irradiance", kStrength, light.irradiance);
    return light;
}

Light parse_point(const KeyValues& keys, const FileFrame& frame) {
    PointLight light;
    light.position_ws = frame.point(keys.vector("position", kCoordinate));
    light.intensity = keys.color("intensity", kStrength, light.intensity);
    return light;
}

Light parse_spot(const KeyValues& keys, const FileFrame& frame) {
    const DVec3 position = keys.vector("position", kCoordinate);
    const DVec3 axis = frame.direction(keys.vector("target", kCoordinate) - position);
    if (glm::length(axis) == 0.0) {
        fail_usage("{}: is the light's own position", keys.label("target"));
    }
    SpotLight light;
    light.position_ws = frame.point(position);
    light.direction_ws = Vec3(axis / glm::length(axis));
    light.intensity = keys.color("intensity", kStrength, light.intensity);
    const double outer = keys.number("outer", kSpotAngle, degrees(light.outer_angle_rad));
    const double inner = keys.number("inner", kSpotAngle, degrees(light.inner_angle_rad));
    if (inner >= outer) {
        fail_usage("{}: {} is not below outer, {} degrees", keys.label("inner"), inner, outer);
    }
    light.outer_angle_rad = radians_of(outer);
    light.inner_angle_rad = radians_of(inner);
    return light;
}

Light parse_sphere(const KeyValues& keys, const FileFrame& frame) {
    SphereLight light;
    light.center_ws = frame.point(keys.vector("center", kCoordinate));
    light.radius_m = static_cast<float>(keys.number("radius", kLength, light.radius_m));
    light.radiance = keys.color("radiance", kStrength, light.radiance);
    return light;
}

Light parse_disc(const KeyValues& keys, const FileFrame& frame) {
    DiscLight light;
    light.center_ws = frame.point(keys.vector("center", kCoordinate));
    light.normal_ws = unit_direction(keys, "normal", frame);
    light.radius_m = static_cast<float>(keys.number("radius", kLength, light.radius_m));
    light.radiance = keys.color("radiance", kStrength, light.radiance);
    return light;
}

Light parse_rect(const KeyValues& keys, const FileFrame& frame) {
    RectLight light;
    light.center_ws = frame.point(keys.vector("center", kCoordinate));
    const DVec3 half_u = frame.direction(keys.vector("u", kCoordinate));
    const DVec3 half_v = frame.direction(keys.vector("v", kCoordinate));
    const double area = glm::length(half_u) * glm::length(half_v);
    if (area == 0.0 || std::abs(glm::dot(half_u, half_v)) > kRightAngleTolerance * area) {
        fail_usage("{}: is not at right angles to u, or one of them is 0,0,0", keys.label("v"));
    }
    light.half_u_ws = Vec3(half_u);
    light.half_v_ws = Vec3(half_v);
    light.radiance = keys.color("radiance", kStrength, light.radiance);
    return light;
}

struct LightGrammar {
    std::string_view kind;
    std::vector<Key> keys;
    std::string_view example;
    Light (*parse)(const KeyValues&, const FileFrame&);
};

const std::array<LightGrammar, 6>& light_grammars() {
    constexpr bool kRequired = true;
    static const std::array<LightGrammar, 6> kGrammars{{
        {"sun",
         {{"elevation", kRequired}, {"azimuth", kRequired}, {"diameter"}, {"irradiance"}, {"name"}},
         "sun:elevation=35,azimuth=120",
         parse_sun},
        {"point",
         {{"position", kRequired}, {"intensity"}, {"name"}},
         "point:position=0,3,0",
         parse_point},
        {"spot",
         {{"position", kRequired},
          {"target", kRequired},
          {"inner"},
          {"outer"},
          {"intensity"},
          {"name"}},
         "spot:position=0,5,0,target=1,0,0,outer=30",
         parse_spot},
        {"sphere",
         {{"center", kRequired}, {"radius", kRequired}, {"radiance"}, {"name"}},
         "sphere:center=0,3,0,radius=0.2",
         parse_sphere},
        {"disc",
         {{"center", kRequired},
          {"normal", kRequired},
          {"radius", kRequired},
          {"radiance"},
          {"name"}},
         "disc:center=0,3,0,normal=0,-1,0,radius=0.5",
         parse_disc},
        {"rect",
         {{"center", kRequired}, {"u", kRequired}, {"v", kRequired}, {"radiance"}, {"name"}},
         "rect:center=0,3,0,u=0.5,0,0,v=0,0,0.5",
         parse_rect},
    }};
    return kGrammars;
}

const LightGrammar& find_light_grammar(std::string_view kind) {
    std::vector<std::string_view> kinds;
    for (const LightGrammar& grammar : light_grammars()) {
        if (grammar.kind == kind) return grammar;
        kinds.push_back(grammar.kind);
    }
    fail_usage("{}: unknown kind \"{}\"{}; kinds: {}", kLightFlag, kind, suggestion(kind, kinds),
               join(kinds));
}

}  // namespace

DVec3 FileFrame::direction(DVec3 file) const {
    return z_up ? DVec3(file.x, file.z, -file.y) : file;
}

Vec3 FileFrame::point(DVec3 file_m) const {
    return Vec3(direction(file_m) - origin_offset_m);
}

DVec3 FileFrame::file_point_m(Vec3 point_ws) const {
    const DVec3 p = DVec3(point_ws) + origin_offset_m;
    return z_up ? DVec3(p.x, 0.0 - p.z, p.y) : p;  // never -0
}

Light parse_light(std::string_view text, const FileFrame& frame) {
    const std::size_t colon = text.find(':');
    const LightGrammar& grammar = find_light_grammar(text.substr(0, colon));
    const std::string_view rest = colon == std::string_view::npos ? "" : text.substr(colon + 1);
    const KeyValues keys(fmt::format("{} {}", kLightFlag, grammar.kind), rest, grammar.keys,
                         fmt::format("{} {}", kLightFlag, grammar.example));
    Light light = grammar.parse(keys, frame);
    std::visit([&](auto& member) { member.name = keys.text("name", grammar.kind); }, light);
    validate(light);
    return light;
}

bool is_camera_pose(std::string_view text) {
    return text.find('=') != std::string_view::npos;
}

Camera parse_camera(std::string_view text, const FileFrame& frame) {
    constexpr Key kKeys[] = {{"eye", true}, {"target", true}, {"fov"}, {"near"}};
    const KeyValues keys(std::string(kCameraFlag), text, kKeys,
                         "--camera eye=8,5,8,target=0,1,0,fov=45");
    const Vec3 eye_ws = frame.point(keys.vector("eye", kCoordinate));
    const Vec3 target_ws = frame.point(keys.vector("target", kCoordinate));
    if (eye_ws == target_ws) {
        fail_usage("{}: is where the eye is: \"{}\"", keys.label("target"), keys.text("eye", ""));
    }
    Camera camera =
        look_at(eye_ws, target_ws, radians_of(keys.number("fov", kFov, kDefaultFovDeg)));
    camera.near_m = static_cast<float>(keys.number("near", kLength, camera.near_m));
    camera.validate();
    return camera;
}

}  // namespace gnomon::cli
