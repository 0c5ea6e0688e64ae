#pragma once

// OctoMap's castRay, a template, prints a line for every ray that leaves the map. The tests cast many of
// those on purpose.
#include <octomap/octomap_types.h>
#undef OCTOMAP_WARNING
#undef OCTOMAP_WARNING_STR
#undef OCTOMAP_ERROR
#undef OCTOMAP_ERROR_STR
#define OCTOMAP_WARNING(...) ((void)0)
#define OCTOMAP_WARNING_STR(args) ((void)0)
#define OCTOMAP_ERROR(...) ((void)0)
#define OCTOMAP_ERROR_STR(args) ((void)0)
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
