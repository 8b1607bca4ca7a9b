#pragma once

namespace gnomon {

/// Seconds of the processor that this thread has taken, from any start: other programs do not
/// count. The wall's clock where the system does not tell.
double thread_seconds();

}  // namespace gnomon
