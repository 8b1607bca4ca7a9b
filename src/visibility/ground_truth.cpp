// The ground truth and the judgement by it: rays from the receivers of a frame.

#include <gnomon/metrics.h>

#include "base/check.h"
#include "trace/light_sample.h"
#include "visibility/edge_probe.h"
#include "visibility/visibility_impl.h"

#include <cmath>

namespace gnomon {

namespace {

constexpr int kMaxSamples = 65536;

/// Sine of the least angle by which a light rises above the plane of a receiver that is judged. The
/// normals that techniques on the device are given are off by up to 6.1e-5 rad
/// (raster/octahedral.glsl): below that they face the light or not at random.
constexpr float kMinLightSine = 1e-4f;

bool clearly_faces_light(const trace::Receiver& receiver, const Light& light) {
    if (!trace::faces_light(receiver, light)) return false;
    const Vec3 highest = trace::highest_direction(receiver, light);
    return glm::dot(receiver.normal_ws, highest) > kMinLightSine * glm::length(highest);
}

/// Side in metres of a pixel at a receiver: of a plane through it that faces the camera.
float pixel_size_m(const Frame& frame, Vec3 p_ws) {
    const auto height = static_cast<float>(frame.size.height);
    if (frame.camera.ortho_height_m > 0.0f) return frame.camera.ortho_height_m / height;
    const float distance_m = -(frame.camera.view_from_world * Vec4(p_ws, 1.0f)).z;
    return 2.0f * std::tan(0.5f * frame.camera.fov_y_rad) * distance_m / height;
}

/// A spot shines on nothing outside its cone: there is no irradiance that could be in the way.
bool within_cone(const Light& light, Vec3 p_ws) {
    const auto* spot = std::get_if<SpotLight>(&light);
    if (spot == nullptr) return true;
    const Vec3 from_light = p_ws - spot->position_ws;
    return glm::dot(from_light, spot->direction_ws) >=
           std::cos(spot->outer_angle_rad) * glm::length(from_light);
}

}  // namespace

Visibility trace_visibility(Context& context, const Frame& frame, const TraceOptions& options) {
    Progress silent;
    return trace_visibility(context, frame, options, silent);
}

Visibility trace_visibility(Context& context, const Frame& frame, const TraceOptions& options,
                            Progress& progress) {
    frame.validate();
    if (options.samples < 1 || options.samples > kMaxSamples) {
        fail_input("trace_visibility: samples is {}; it must be in [1, {}]", options.samples,
                   kMaxSamples);
    }
    Context::Impl& impl = context.impl();
    const std::shared_ptr<const trace::Tracer> tracer =
        impl.tracer(frame.scene, frame.ignore_alpha, progress);
    const std::shared_ptr<FrameReceivers> receivers = impl.receiver_points(frame, progress);
    Visibility visibility;
    tracer->visibility(receivers->points, frame.size, frame.light, options.samples, options.seed,
                       visibility.impl().host_target(impl, frame.size).pixels(), progress);
    return visibility;
}

ComparisonMask comparison_mask(Context& context, const Frame& frame) {
    frame.validate();
    Progress silent;
    Context::Impl& impl = context.impl();
    const std::shared_ptr<FrameReceivers> receivers = impl.receiver_points(frame, silent);
    ComparisonMask mask{Image(frame.size, 1), Image(frame.size, 1),
                        make_edge_probe(impl.tracer(frame.scene, frame.ignore_alpha, silent),
                                        receivers->points, frame.light)};
    for (std::size_t i = 0; i < receivers->points.size(); ++i) {
        const trace::Receiver& receiver = receivers->points[i];
        if (!receiver.exists()) continue;
        const bool judged = clearly_faces_light(receiver, frame.light) &&
                            within_cone(frame.light, receiver.position_ws);
        mask.facing.pixels()[i] = judged ? 1.0f : 0.0f;
        mask.pixel_size_m.pixels()[i] = pixel_size_m(frame, receiver.position_ws);
    }
    return mask;
}

Comparison compare(const Visibility& visibility, const Visibility& truth,
                   const ComparisonMask& mask) {
    const Image& texel_size_m = visibility.texel_size_m();
    if (visibility.impl().has_texels_across_light()) {
        return compare(visibility.image(), truth.image(), mask, texel_size_m,
                       visibility.filter_radius_texels());
    }
    return compare(visibility.image(), truth.image(), {mask.facing, mask.pixel_size_m, nullptr},
                   texel_size_m, visibility.filter_radius_texels());
}

}  // namespace gnomon
