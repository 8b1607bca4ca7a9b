#pragma once

#include <gnomon/vertex_lighting.h>

#include "trace/tracer.h"

#include <span>
#include <vector>

namespace gnomon::lighting {

/// Apart from the truth's seed, and from that of techniques' rays.
inline constexpr unsigned kVertexSeed = 4;

/// trace_vertex_lights() of one light at receivers; what does not exist sees nothing.
std::vector<VertexLight> trace_vertex_light(const trace::Tracer& tracer,
                                            std::span<const trace::Receiver> vertices,
                                            const Light& light, int samples, unsigned seed,
                                            Progress& progress);

float luminance(Vec3 linear_rgb);

/// Throws Error{input}.
void check_samples(int samples);

}  // namespace gnomon::lighting
