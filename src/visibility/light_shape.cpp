#include "visibility/light_shape.h"

#include <cassert>
#include <cmath>

namespace gnomon {

namespace {

struct ToShape {
    shared::LightShape operator()(const DirectionalLight& light) const {
        return {.position = light.to_light_ws,
                .kind = shared::kLightDirectional,
                .radius = std::sin(0.5f * light.angular_diameter_rad)};
    }
    shared::LightShape operator()(const PointLight& light) const {
        return {.position = light.position_ws, .kind = shared::kLightPoint};
    }
    shared::LightShape operator()(const SpotLight& light) const {
        return {.position = light.position_ws, .kind = shared::kLightPoint};
    }
    shared::LightShape operator()(const SphereLight& light) const {
        return {
            .position = light.center_ws, .kind = shared::kLightSphere, .radius = light.radius_m};
    }
    shared::LightShape operator()(const DiscLight& light) const {
        return {.position = light.center_ws,
                .kind = shared::kLightDisc,
                .radius = light.radius_m,
                .normal = light.normal_ws};
    }
    shared::LightShape operator()(const RectLight& light) const {
        return {.position = light.center_ws,
                .kind = shared::kLightRect,
                .half_u = light.half_u_ws,
                .half_v = light.half_v_ws,
                .normal = normalize(glm::cross(light.half_u_ws, light.half_v_ws))};
    }
};

}  // namespace

shared::LightShape light_shape(const Light& light) {
    return std::visit(ToShape{}, light);
}

DVec3 center_ws(const Light& light) {
    assert(!std::holds_alternative<DirectionalLight>(light));
    return DVec3(light_shape(light).position);
}

bool same_place(const Light& a, const Light& b) {
    const shared::LightShape p = light_shape(a);
    const shared::LightShape q = light_shape(b);
    return a.index() == b.index() && p.position == q.position && p.radius == q.radius &&
           p.half_u == q.half_u && p.half_v == q.half_v && p.normal == q.normal;
}

shared::ReceiverPush receiver_push(const raster::Receivers& receivers, const Light& light) {
    shared::ReceiverPush push{.es_from_clip = receivers.eye_from_clip(),
                              .light = light_shape(light),
                              .size = {receivers.size.width, receivers.size.height}};
    if (push.light.kind != shared::kLightDirectional)
        push.light.position -= receivers.camera.eye_ws();
    return push;
}

}  // namespace gnomon
