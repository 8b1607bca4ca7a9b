#pragma once

#include "visibility/context_impl.h"

#include <functional>
#include <memory>

namespace gnomon {

/// Side in metres of a technique's texel at a point of the world.
using TexelSize = std::function<float(Vec3 p_ws)>;
/// The same of texels that lie on the receivers.
using TexelSizeOn = std::function<float(const trace::Receiver& receiver)>;

/// An image of one float a pixel that is on the device, on the host, or both. Must not outlive the
/// Context that it was rendered with.
class Visibility::Impl {
public:
    Extent size() const { return size_; }

    /// An R32F storage image of that size for a technique to write; what was held is void.
    gpu::Image& device_target(Context::Impl& context, Extent size);
    /// A 1-channel image of that size for a technique to write; what was held is void.
    Image& host_target(Context::Impl& context, Extent size);
    /// The commands that were to write the target did not run: nothing is held.
    void forget();

    const Image& on_host();
    gpu::Image& on_device();

    /// Tells the texels of what was rendered for `frame`, which lie across the light.
    void set_texels(TexelSize texel_size, float filter_radius_texels, const Frame& frame);
    /// The same of texels that lie on the receivers.
    void set_texels(TexelSizeOn texel_size, float filter_radius_texels, const Frame& frame);
    /// The same by one value a pixel.
    void set_texels(Image texel_size_m, float filter_radius_texels);
    /// Made from the receivers at the first call, unless it was given.
    const Image& texel_size_m();
    bool has_texels_across_light() const { return texel_size_ != nullptr; }
    float filter_radius_texels() const { return filter_radius_texels_; }

private:
    void reset(Context::Impl& context, Extent size);
    void allocate_on_device();

    Context::Impl* context_ = nullptr;
    Extent size_;
    bool host_valid_ = false, device_valid_ = false;
    Image host_;
    gpu::Image device_;
    TexelSize texel_size_;
    TexelSizeOn texel_size_on_;
    float filter_radius_texels_ = 0.0f;
    std::optional<Frame> frame_;
    Image texel_image_;
};

}  // namespace gnomon
