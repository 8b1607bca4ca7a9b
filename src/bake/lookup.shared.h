#ifndef GNOMON_BAKE_LOOKUP_SHARED_H
#define GNOMON_BAKE_LOOKUP_SHARED_H

// What look-ups in double and on the device agree upon.

#ifdef __cplusplus
#include <cstdint>
namespace gnomon::bake::shared {
using uint = std::uint32_t;
#endif

// Of places, whose spread along one axis times that across it, as part of the square of their sum,
// is 1/4 for the corners of a square and 3/16 for three of them: the rest is nearly in a line.
const float kLeastSpread = 0.02f;

// Slower edges are so nearly along the path that their slope is not known so well.
const float kMostSlowness = 4.0f;

// In codes per texel. Times are whole codes: slopes that are less are rounding, of times that are
// all the same.
const float kLeastSlope = 1.0f / 32.0f;

// Of the light's angle to a surface that it grazes: a tenth of a degree.
const float kLeastSine = 0.002f;

// Of the path: edges whose times are farther apart have nothing to do with each other, or pass so
// slowly that samples between them tell more. Three quarters of an hour of thirteen.
const float kMostApart = 1.0f / 16.0f;

// Of a texel: parts in which it tells where it asks. Others are up to 3.5 texels away: padding,
// burial, half.
const int kPlaceCodes = 32;

// PathEnds as bits.
const uint kClosed = 1u;
const uint kBeginsUp = 2u;
const uint kEndsUp = 4u;

#ifdef __cplusplus
}  // namespace gnomon::bake::shared
#endif

#endif
