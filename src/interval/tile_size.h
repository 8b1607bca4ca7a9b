#pragma once

#include <array>
#include <cstddef>

namespace gnomon::interval {

/// How many receivers to trace together, learned on the way: neighbours in the list are mostly
/// alike. Times are seconds for a receiver. One for each thread.
class TileSize {
public:
    /// Tiles of 4 are nowhere the fastest, and often slower than both single receivers and 16: they
    /// would keep from trying these.
    static constexpr std::array<int, 3> kSizes = {1, 16, 64};

    int size() const { return kSizes[at_]; }
    int smaller_size() const { return kSizes[at_ - 1]; }
    int larger_size() const { return kSizes[at_ + 1]; }

    /// Tiles are given up after so long: where receivers are far apart they can take a hundred
    /// times as long as these would singly.
    double limit_s() const;

    /// What is to be tried with the next receivers, beside the size.
    enum class Trial { none, smaller, larger };
    Trial next_trial();

    /// Receivers took `s`.
    void took(double s);
    /// A tile was given up whose receivers take `single_s` singly. The size is now smaller, or the
    /// limit is higher, because all takes long there.
    void was_late(double single_s);
    /// Tiles of another size took `other_s` where those of the size took `s`.
    void tried(Trial trial, double other_s, double s);

private:
    void move_to(std::size_t at);

    /// Of one kind: how many groups of receivers to wait for the next, longer after each that was
    /// in vain.
    struct Wait {
        int groups = 1, left = 1;
        bool over();
        void longer();
    };

    std::size_t at_ = 0;
    double typical_s_ = 0.0, single_s_ = 0.0;
    Wait smaller_, larger_;
};

}  // namespace gnomon::interval
