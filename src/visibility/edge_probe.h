#pragma once

#include <gnomon/light.h>
#include <gnomon/metrics.h>

#include "trace/tracer.h"

#include <memory>
#include <span>

namespace gnomon {

/// The truth's edges by rays to the middle of the light, from points around receivers. Null for
/// lights whose middle does not stand for them: areas. `receivers` are those of the picture's
/// pixels; they are copied.
std::shared_ptr<const EdgeProbe> make_edge_probe(std::shared_ptr<const trace::Tracer> tracer,
                                                 std::span<const trace::Receiver> receivers,
                                                 const Light& light);

}  // namespace gnomon
