#pragma once

#include <frontlux/stopwatch.hpp>
