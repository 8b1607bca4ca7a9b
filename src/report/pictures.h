#pragma once

#include <gnomon/image.h>

#include <string>

namespace gnomon::report {

/// sRGB colour of a signed difference V - T in [-1, 1] (clamped): blue where the technique is too
/// dark, orange where it is too bright, near-white at 0. Lightness falls linearly with |V - T| and
/// equally on both sides; blue and orange stay apart for every common colour blindness.
/// Lightness and chroma are OKLab's: B. Ottosson, "A perceptual color space for image processing",
/// 2020.
Vec3 difference_color(float difference);

/// The colour scale from -1 to 1 as a CSS gradient's list of stops.
std::string difference_gradient_css();

/// V - T in difference_color, 3 channels; pixels that are not judged (`facing` <= 0) are hatched
/// grey. All three images have 1 channel and one size.
Image difference_image(const Image& visibility, const Image& truth, const Image& facing);

/// A part of an image, in pixels from its top left.
struct Window {
    unsigned x = 0, y = 0, width = 0, height = 0;
    double error_sum = 0.0;  ///< of |V - T| over its judged pixels; 0 when there is no difference
};

/// The window of `side` x `side` pixels (less where the image is smaller) with the largest sum of
/// |V - T| over its judged pixels; of equal ones the topmost, then leftmost.
Window worst_window(const Image& visibility, const Image& truth, const Image& facing,
                    unsigned side);

/// Truth, technique and difference inside `window` side by side, each pixel as a square of `scale`
/// pixels, with gaps of `gap` pixels between them: 4 channels, the gaps transparent.
Image worst_strip(const Image& visibility, const Image& truth, const Image& difference,
                  const Window& window, unsigned scale, unsigned gap);

}  // namespace gnomon::report
