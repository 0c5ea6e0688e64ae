#pragma once

/// A name that leaves the shared libraries. They are compiled with hidden visibility: what does not bear this
/// is theirs alone.
#define FRONTLUX_EXPORT __attribute__((visibility("default")))
