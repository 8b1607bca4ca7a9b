#include "base/check.h"
#include "visibility/visibility_impl.h"

#include <cstring>

namespace gnomon {

namespace {

constexpr unsigned kMaxFrameSide = 16384;

std::uint64_t byte_count(Extent size) {
    return std::uint64_t{size.width} * size.height * sizeof(float);
}

}  // namespace

void Frame::validate() const {
    if (size.width < 1 || size.height < 1 || size.width > kMaxFrameSide ||
        size.height > kMaxFrameSide) {
        fail_input("frame: size is {}x{}; each side must be in [1, {}]", size.width, size.height,
                   kMaxFrameSide);
    }
    camera.validate();
    gnomon::validate(light);
}

Visibility::Visibility() : impl_(std::make_unique<Impl>()) {}
Visibility::~Visibility() = default;
Visibility::Visibility(Visibility&&) noexcept = default;
Visibility& Visibility::operator=(Visibility&&) noexcept = default;

Extent Visibility::size() const {
    return impl_->size();
}
const Image& Visibility::image() const {
    return impl_->on_host();
}
const Image& Visibility::texel_size_m() const {
    return impl_->texel_size_m();
}
float Visibility::filter_radius_texels() const {
    return impl_->filter_radius_texels();
}

void Visibility::Impl::reset(Context::Impl& context, Extent size) {
    context_ = &context;
    size_ = size;
    host_valid_ = device_valid_ = false;
    texel_size_ = nullptr;
    texel_size_on_ = nullptr;
    filter_radius_texels_ = 0.0f;
    frame_.reset();
    texel_image_ = {};
}

gpu::Image& Visibility::Impl::device_target(Context::Impl& context, Extent size) {
    reset(context, size);
    allocate_on_device();
    device_valid_ = true;
    return device_;
}

void Visibility::Impl::forget() {
    reset(*context_, {});
    host_ = {};
    device_ = {};
}

void Visibility::Impl::allocate_on_device() {
    if (device_ && device_.size() == size_) return;
    constexpr VkImageUsageFlags kUsage = VK_IMAGE_USAGE_STORAGE_BIT |
                                         VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                         VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    device_ = gpu::Image(context_->device(),
                         {.size = size_, .format = VK_FORMAT_R32_SFLOAT, .usage = kUsage});
}

Image& Visibility::Impl::host_target(Context::Impl& context, Extent size) {
    reset(context, size);
    if (host_.size() != size) host_ = Image(size, 1);
    host_valid_ = true;
    return host_;
}

const Image& Visibility::Impl::on_host() {
    if (host_valid_ || !device_valid_) return host_;
    if (host_.size() != size_) host_ = Image(size_, 1);
    gpu::Buffer staging(context_->device(), byte_count(size_), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                        gpu::Placement::readback);
    gpu::Commands commands = context_->submission().begin();
    commands.use(device_, gpu::Use::copy_source);
    commands.use(staging, gpu::Use::copy_target);
    commands.copy(device_, staging);
    commands.use(staging, gpu::Use::host_read);
    context_->submission().submit_and_wait();
    std::memcpy(host_.pixels().data(), staging.mapped(), byte_count(size_));
    host_valid_ = true;
    return host_;
}

gpu::Image& Visibility::Impl::on_device() {
    if (device_valid_) return device_;
    if (!host_valid_) fail_input("visibility: nothing has been rendered into it");
    Context::Impl& context = *context_;
    allocate_on_device();
    gpu::Buffer staging(context.device(), byte_count(size_), VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                        gpu::Placement::upload);
    std::memcpy(staging.mapped(), host_.pixels().data(), byte_count(size_));
    gpu::Commands commands = context.submission().begin();
    commands.use(device_, gpu::Use::copy_target);
    commands.copy(staging, device_);
    commands.use(device_, gpu::Use::storage_read);
    context.submission().submit_and_wait();
    device_valid_ = true;
    return device_;
}

void Visibility::Impl::set_texels(TexelSize texel_size, float filter_radius_texels,
                                  const Frame& frame) {
    texel_size_ = std::move(texel_size);
    filter_radius_texels_ = filter_radius_texels;
    frame_ = frame;
}

void Visibility::Impl::set_texels(TexelSizeOn texel_size, float filter_radius_texels,
                                  const Frame& frame) {
    texel_size_on_ = std::move(texel_size);
    filter_radius_texels_ = filter_radius_texels;
    frame_ = frame;
}

void Visibility::Impl::set_texels(Image texel_size_m, float filter_radius_texels) {
    texel_image_ = std::move(texel_size_m);
    filter_radius_texels_ = filter_radius_texels;
}

const Image& Visibility::Impl::texel_size_m() {
    if (!(texel_size_ || texel_size_on_) || !texel_image_.empty()) return texel_image_;
    Progress silent;
    const std::shared_ptr<FrameReceivers> receivers = context_->receiver_points(*frame_, silent);
    texel_image_ = Image(size_, 1);
    for (std::size_t i = 0; i < receivers->points.size(); ++i) {
        const trace::Receiver& receiver = receivers->points[i];
        if (!receiver.exists()) continue;
        texel_image_.pixels()[i] =
            texel_size_on_ ? texel_size_on_(receiver) : texel_size_(receiver.position_ws);
    }
    return texel_image_;
}

}  // namespace gnomon
