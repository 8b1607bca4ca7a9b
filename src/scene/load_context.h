#pragma once

#include <gnomon/progress.h>
#include <gnomon/scene.h>

#include "scene/load_files.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::scene {

/// The faults that a loader tolerates, each kind once however often it occurs.
class Warnings {
public:
    /// `fault` is a clause ("texture cannot be read"), `where` a name that tells the places apart,
    /// `amount` how many things are concerned there.
    void add(std::string_view fault, std::string_view where = {}, std::uint64_t amount = 1);

    /// A line for each kind of fault, in the order of their first occurrence:
    /// "texture cannot be read: a.png, b.png, c.png and 58 more".
    std::vector<std::string> lines() const;

private:
    struct Entry {
        std::string fault;
        std::vector<std::string> examples;
        std::uint64_t places = 0;
        std::uint64_t amount = 0;
        bool counted = false;  // the amount says more than the places
    };
    std::vector<Entry> entries_;
};

/// What every part of a loader needs.
struct LoadContext {
    const SceneFiles& files;
    const LoadOptions& options;
    Warnings& warnings;
    Progress& progress;
};

/// `text` in one line of printable characters, at most `max_length` bytes, for messages that quote
/// files.
std::string quotable(std::string_view text, std::size_t max_length = 120);

}  // namespace gnomon::scene
