#pragma once

// A value behind a pointer, for headers that declare many settings without including the headers of all.

#include <memory>
#include <utility>

namespace pertev {

/// A value of type T that is complete only where it is read or changed: a header that declares a SharedValue<T> needs
/// only T's name. Copies share the value until one of them is changed, as `edit()` then makes its own. Threads may read
/// one object at once.
template <class T>
class SharedValue {
public:
    SharedValue() = default; // T{}
    SharedValue(T value) : value_(std::make_shared<T>(std::move(value))) {}
    SharedValue& operator=(T value) {
        value_ = std::make_shared<T>(std::move(value));
        return *this;
    }

    const T& operator*() const {
        static const T none{};
        return value_ ? *value_ : none;
    }
    const T* operator->() const { return &**this; }

    /// The value, to be changed; no other object sees the change.
    T& edit() {
        if (value_.use_count() != 1) value_ = std::make_shared<T>(**this);
        return *value_;
    }

    friend bool operator==(const SharedValue& a, const SharedValue& b) { return a.value_ == b.value_ || *a == *b; }

private:
    std::shared_ptr<T> value_; // null: T{}
};

} // namespace pertev
