#!/usr/bin/env python3
"""What leaves the shared libraries: symbols_test.py NM LIBRARY... counts the names that each of them defines for others,
and fails if one of frontlux::detail or of a namespace detail below is among them, or a public one is not."""

import re
import subprocess
import sys

# Templates in <frontlux/parallel.hpp> call these, in whatever program includes it.
CALLED_FROM_HEADERS = {"frontlux::detail::run_ranges", "frontlux::detail::isolate"}
PUBLIC = {
    "engine": ["frontlux::make_ray_caster", "frontlux::read_octree", "frontlux::OctreeRayCaster::castRay",
               "frontlux::FieldOfView::check", "frontlux::LiveMap::update",
               "frontlux::operator=="],
    "planner": ["frontlux::planner::plan_path", "frontlux::planner::Exploration::step",
                "frontlux::planner::ContinuousExploration::plan", "frontlux::planner::read_recording",
                "typeinfo for frontlux::planner::UnbegunRecording"],
    "io": ["frontlux::io::read_robot", "frontlux::io::read_task"],
}


def exported(nm, library):
    """The names that a library defines for others, without their arguments."""
    listed = subprocess.run([nm, "--dynamic", "--defined-only", "--demangle", "--format=posix", library], check=True,
                            capture_output=True, text=True).stdout
    names = (re.match(r"(.*) [A-Za-z] [0-9a-f]+( [0-9a-f]*)?$", line) for line in listed.splitlines())
    return {name[1] for name in names if name}


def main():
    nm, libraries = sys.argv[1], sys.argv[2:]
    complaints = []
    for library in libraries:
        names = exported(nm, library)
        plain = {re.sub(r"(\[abi:\w+\])?\(.*", "", name) for name in names}
        private = {name for name in names if re.search(r"^(\w+ (table )?for )*frontlux::(\w+::)*detail::", name)}
        private = {name for name in private if name.split("(")[0] not in CALLED_FROM_HEADERS}
        complaints += [f"{library}: exports {name}" for name in sorted(private)]
        part = re.search(r"frontlux_(\w+?)(_shared)?\.so", library)[1]
        complaints += [f"{library}: does not export {name}" for name in PUBLIC[part] if name not in plain]
        ours = sum("frontlux::" in name for name in names)
        print(f"{library}: {ours} names of ours, {len(names) - ours} others, {len(private)} private")
    if complaints:
        sys.exit("\n".join(complaints))


if __name__ == "__main__":
    main()
