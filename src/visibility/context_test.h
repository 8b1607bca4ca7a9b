#pragma once

#include <gnomon/context.h>

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace gnomon {

/// Base of tests with a Context, one for all tests of a suite: what the validation layer says fails
/// the test that it says it in.
class ContextTest : public testing::Test {
protected:
    static void SetUpTestSuite() {
        context_ = std::make_unique<Context>(ContextOptions{.validation = true});
    }
    static void TearDownTestSuite() { context_.reset(); }

    void SetUp() override { messages_before_ = context().validation_messages().size(); }
    void TearDown() override {
        const std::vector<std::string> messages = context().validation_messages();
        for (std::size_t i = messages_before_; i < messages.size(); ++i)
            ADD_FAILURE() << messages[i];
    }

    static Context& context() { return *context_; }

private:
    static inline std::unique_ptr<Context> context_;
    std::size_t messages_before_ = 0;
};

}  // namespace gnomon
