#pragma once

// OctoMap reports rays that leave its key range on stderr, from inside the header that holds castRay. A
// library must not print, a benchmark must not time what is printed, and the tests cast many such rays on
// purpose. So all files that may cast by OctoMap include it from here, where its macros print nothing.
#include <octomap/octomap_types.h>
#undef OCTOMAP_WARNING
#undef OCTOMAP_ERROR
#undef OCTOMAP_WARNING_STR
#undef OCTOMAP_ERROR_STR
#define OCTOMAP_WARNING(...) ((void)0)
#define OCTOMAP_ERROR(...) ((void)0)
#define OCTOMAP_WARNING_STR(args) ((void)0)
#define OCTOMAP_ERROR_STR(args) ((void)0)
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
