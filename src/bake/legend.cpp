// False colours: viridis, S. van der Walt and N. Smith, "A Better Default Colormap for Matplotlib",
// SciPy 2015, by a polynomial that M. Zucker fitted to its table ("viridis, plasma, inferno,
// magma", Shadertoy WlfXRN, 2019, CC0): within 0.02 of it in each channel.
// Text: Sean Barrett's stb_easy_font.h, drawn at twice its size.

#include "bake/legend.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <stb_easy_font.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace gnomon::bake {

namespace {

constexpr int kTextScale = 2;
constexpr int kFontLine_px = 12;  // stb_easy_font's

constexpr Vec3 kPaper(1.0f);
constexpr Vec3 kInk(0.15f);

// Of the strip.
constexpr int kMargin_px = 14;
constexpr int kBar_px = 26;
constexpr int kTick_px = 6;
constexpr unsigned kStrip_px = 190;

/// stb_easy_font's vertices.
struct Vertex {
    float x, y, z;
    std::array<unsigned char, 4> color;
};

std::string printable(std::string_view text) {
    std::string clean(text);
    std::ranges::replace_if(
        clean, [](char c) { return c < ' ' || c > '~'; }, '?');
    return clean;
}

}  // namespace

Vec3 false_color(double t) {
    static constexpr std::array<DVec3, 7> kCoefficients = {
        DVec3(0.2777273272234177, 0.005407344544966578, 0.3340998053353061),
        DVec3(0.1050930431085774, 1.404613529898575, 1.384590162594685),
        DVec3(-0.3308618287255563, 0.214847559468213, 0.09509516302823659),
        DVec3(-4.634230498983486, -5.799100973351585, -19.33244095627987),
        DVec3(6.228269936347081, 14.17993336680509, 56.69055260068105),
        DVec3(4.776384997670288, -13.74514537774601, -65.35303263337234),
        DVec3(-5.435455855934631, 4.645852612178535, 26.3124352495832)};
    t = std::clamp(t, 0.0, 1.0);
    DVec3 color(0.0);
    std::for_each(kCoefficients.rbegin(), kCoefficients.rend(),
                  [&](const DVec3& coefficient) { color = color * t + coefficient; });
    return Vec3(glm::clamp(color, 0.0, 1.0));
}

unsigned text_height_px() {
    return kTextScale * kFontLine_px;
}

unsigned text_width_px(std::string_view text) {
    std::string clean = printable(text);
    return static_cast<unsigned>(kTextScale * stb_easy_font_width(clean.data()));
}

void fill_rectangle(Image& image, int x, int y, int width, int height, Vec3 color) {
    const auto end = [](int from, int length, unsigned side) {
        return static_cast<unsigned>(std::clamp(from + length, 0, static_cast<int>(side)));
    };
    for (unsigned j = end(y, 0, image.height()); j < end(y, height, image.height()); ++j) {
        for (unsigned i = end(x, 0, image.width()); i < end(x, width, image.width()); ++i) {
            for (int channel = 0; channel < 3; ++channel)
                image.at(i, j, channel) = color[channel];
        }
    }
}

void draw_text(Image& image, int x, int y, std::string_view text, Vec3 color) {
    constexpr std::size_t kVerticesPerLetter = 100;  // more than any letter has
    std::string clean = printable(text);
    std::vector<Vertex> vertices(kVerticesPerLetter * (clean.size() + 1));
    const int quads = stb_easy_font_print(0.0f, 0.0f, clean.data(), nullptr, vertices.data(),
                                          static_cast<int>(vertices.size() * sizeof(Vertex)));
    for (std::size_t quad = 0; quad < static_cast<std::size_t>(quads); ++quad) {
        const Vertex &low = vertices[4 * quad], &high = vertices[4 * quad + 2];
        const auto scaled = [](float at) { return static_cast<int>(std::lround(kTextScale * at)); };
        fill_rectangle(image, x + scaled(low.x), y + scaled(low.y), scaled(high.x) - scaled(low.x),
                       scaled(high.y) - scaled(low.y), color);
    }
}

Image with_legend(const Image& picture, std::string_view title, int greatest_h) {
    const int line = static_cast<int>(text_height_px());
    Image image({picture.width() + kStrip_px, picture.height()}, 3);
    fill_rectangle(image, 0, 0, static_cast<int>(image.width()), static_cast<int>(image.height()),
                   kPaper);
    for (unsigned y = 0; y < picture.height(); ++y) {
        for (unsigned x = 0; x < picture.width(); ++x) {
            for (int channel = 0; channel < 3; ++channel)
                image.at(x, y, channel) = picture.at(x, y, channel);
        }
    }
    const int left = static_cast<int>(picture.width()) + kMargin_px;
    int top = kMargin_px;
    while (!title.empty()) {
        const std::size_t end = std::min(title.find('\n'), title.size());
        draw_text(image, left, top, title.substr(0, end), kInk);
        title.remove_prefix(std::min(end + 1, title.size()));
        top += line;
    }
    top += kMargin_px;
    const int bottom = static_cast<int>(image.height()) - kMargin_px - line / 2;
    const int length = std::max(bottom - top, 1);
    for (int y = 0; y < length; ++y) {
        fill_rectangle(image, left, top + y, kBar_px, 1, false_color(1.0 - (y + 0.5) / length));
    }
    // Every hour, or as many of them as have room.
    int every_h = 1;
    while (length * every_h < 2 * line * greatest_h && every_h < greatest_h)
        ++every_h;
    for (int hour = 0; hour <= greatest_h; hour += every_h) {
        const int y = bottom - length * hour / std::max(greatest_h, 1);
        fill_rectangle(image, left + kBar_px, y - 1, kTick_px, 2, kInk);
        draw_text(image, left + kBar_px + 2 * kTick_px, y - line / 3, fmt::format("{} h", hour),
                  kInk);
    }
    return image;
}

}  // namespace gnomon::bake
