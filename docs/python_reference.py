"""Writes the reference of the Python modules, as a page for Doxygen: python_reference.py PAGE.md

Fails, and names them, if public names have no docstring."""
import inspect
import pathlib
import sys
import types

import frontlux
import frontlux.planner


def names_of(module):
    """The public names that a module defines or hands on from its extension."""
    return [name for name, value in sorted(vars(module).items())
            if not name.startswith("_") and not isinstance(value, types.ModuleType) and
            getattr(value, "__module__", module.__name__).startswith("frontlux")]


def split(value):
    """(signature, text) of a docstring. pybind11 writes the signature into the first line."""
    text = inspect.getdoc(value) or ""
    first, _, rest = text.partition("\n")
    if "(" in first and " -> " in first:
        signature = first.split(" -> ")[0].split("(", 1)[1].removeprefix("self: ")
        begin = signature.find(", ") if "." in signature.split(",")[0] and ":" not in signature.split(",")[0] else -1
        return f"({signature[begin + 2:] if begin >= 0 else signature}", rest.strip()
    if inspect.isfunction(value):
        return str(inspect.signature(value)), text
    return "", text


def block(text):
    return f"\n~~~{{.unparsed}}\n{text}\n~~~\n" if text else ""


def members_of(kind):
    return [(name, member) for name, member in sorted(vars(kind).items())
            if (name == "__init__" or not name.startswith("_")) and
            (callable(member) or isinstance(member, (property, staticmethod)))]


def describe(module, missing):
    lines = [f"\n## {module.__name__}\n", block(inspect.getdoc(module))]
    for name in names_of(module):
        value = getattr(module, name)
        signature, text = split(value) if not inspect.isclass(value) else ("", inspect.getdoc(value))
        lines += [f"\n### {module.__name__}.{name}\n", block(f"{name}{signature}\n\n{text}" if signature else text)]
        if not value.__doc__:
            missing.append(f"{module.__name__}.{name}")
        if not inspect.isclass(value) or issubclass(value, int):
            if inspect.isclass(value):
                lines.append(block("\n".join(f"{member.name} = {member.value}" for member in value)))
            continue
        for member_name, _ in members_of(value):
            member = inspect.getattr_static(value, member_name)
            member = member if isinstance(member, property) else getattr(value, member_name)
            signature, text = split(member)
            if not text:
                missing.append(f"{module.__name__}.{name}.{member_name}")
            title = name if member_name == "__init__" else f"{name}.{member_name}"
            lines.append(block(f"{title}{signature}\n\n" + "\n".join("    " + line for line in text.splitlines())))
    return lines


def main():
    missing = []
    lines = ["# Python reference {#python_reference}\n",
             "Made from the docstrings, which `help(frontlux)` and `help(frontlux.planner)` show, too. "
             "[Python](@ref docs/python.md) has examples.\n"]
    for module in (frontlux, frontlux.planner):
        lines += describe(module, missing)
    if missing:
        sys.exit("these public names have no docstring: " + ", ".join(missing))
    pathlib.Path(sys.argv[1]).write_text("".join(lines))


if __name__ == "__main__":
    main()
