#pragma once

#include <gnomon/progress.h>

namespace gnomon {

/// Tells of a part of a longer task, which is `share` of it and begins at `begin`, both in [0, 1].
class PartProgress final : public Progress {
public:
    PartProgress(Progress& whole, std::string_view task, double begin, double share)
        : whole_(whole), task_(task), begin_(begin), share_(share) {}
    void report(std::string_view, double fraction) override {
        whole_.report(task_, begin_ + share_ * fraction);
    }
    bool cancelled() const override { return whole_.cancelled(); }

private:
    Progress& whole_;
    std::string_view task_;
    double begin_, share_;
};

}  // namespace gnomon
