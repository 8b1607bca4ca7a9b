// `load_scene info --scene FILE`: loads a file as `gnomon info` does, with its exit codes and its
// lines on stderr, built with the sanitizers of the fuzz targets. tests/bad_inputs_test.py runs it.

#include <gnomon/error.h>
#include <gnomon/scene.h>

#include <cstdio>
#include <string_view>

int main(int count, char** arguments) {
    if (count != 4 || std::string_view(arguments[1]) != "info" ||
        std::string_view(arguments[2]) != "--scene") {
        std::fputs("error: usage: load_scene info --scene FILE\n", stderr);
        return 2;
    }
    try {
        const gnomon::Scene scene = gnomon::load_scene(arguments[3]);
        for (const std::string& warning : scene.warnings())
            std::fprintf(stderr, "warning: %s\n", warning.c_str());
        std::printf("%s: %llu triangles\n", arguments[3],
                    static_cast<unsigned long long>(scene.triangle_count()));
        return 0;
    } catch (const gnomon::Error& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return error.kind() == gnomon::ErrorKind::input ? 2 : 1;
    }
}
