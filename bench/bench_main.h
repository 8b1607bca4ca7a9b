#pragma once

#include <gnomon/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace gnomon {

/// Of at least one value; of an even number the upper of the middle two.
inline double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

/// What main() of every benchmark returns: run()'s exit code, or that of its error, which is told.
inline int bench_main(int argc, char** argv, int (*run)(int, char**)) {
    try {
        return run(argc, argv);
    } catch (const Error& error) {
        fmt::print(stderr, "error: {}\n", error.what());
        return error.kind() == ErrorKind::input ? 2 : 1;
    }
}

}  // namespace gnomon
