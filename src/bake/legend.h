#pragma once

#include <gnomon/image.h>
#include <gnomon/math.h>

#include <string_view>

/// What makes numbers readable in a picture.
namespace gnomon::bake {

/// sRGB of `t`, clamped to [0, 1]: the colour map viridis, dark blue to yellow, of even steps to
/// the eye and readable by the colour-blind.
Vec3 false_color(double t);

/// Height of a line of text.
unsigned text_height_px();
unsigned text_width_px(std::string_view text);

/// Printable ASCII, its upper left corner at (x, y); what is outside of the picture is left out.
void draw_text(Image& image, int x, int y, std::string_view text, Vec3 color);

void fill_rectangle(Image& image, int x, int y, int width, int height, Vec3 color);

/// `picture` with a strip at its right: `title`, a line for each line of it, and the colours from 0
/// to `greatest_h`, with hours beside them. 3 channels.
Image with_legend(const Image& picture, std::string_view title, int greatest_h);

}  // namespace gnomon::bake
