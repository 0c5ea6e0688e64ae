"""Writes the reference of the Python modules as a page for Doxygen: python_reference.py PAGE.md

Names and types are those of the stubs, words those of the docstrings; fails, and names them, if there are names without any."""
import ast
import inspect
import pathlib
import sys

import frontlux
import frontlux.planner


def heading(node):
    """`name(arguments) -> type`, or `name -> type` of a property."""
    if isinstance(node, ast.ClassDef):
        return node.name
    result = f" -> {ast.unparse(node.returns)}" if node.returns is not None and node.name != "__init__" else ""
    if any(isinstance(decorator, ast.Name) and decorator.id == "property" for decorator in node.decorator_list):
        return node.name + result
    node.args.args = [argument for argument in node.args.args if argument.arg != "self"]
    return f"{node.name}({ast.unparse(node.args)}){result}"


def block(title, text):
    return f"\n~~~{{.unparsed}}\n{title}\n\n" + "".join(f"    {line}".rstrip() + "\n" for line in text.splitlines()) + "~~~\n"


def words(value):
    """A docstring, without the signature that pybind11 writes into its first line."""
    text = inspect.getdoc(value) or ""
    first, _, rest = text.partition("\n")
    return rest.strip() if "(" in first and " -> " in first else text


def pages_of(module, missing):
    stub = ast.parse((pathlib.Path(module.__file__).parent / "__init__.pyi").read_text(encoding="utf-8"))
    lines = [f"\n## {module.__name__}\n\n{inspect.getdoc(module)}\n"]
    for node in stub.body:
        if not isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            continue
        value = getattr(module, node.name)
        constants = [ast.unparse(member) for member in getattr(node, "body", []) if isinstance(member, ast.Assign)]
        text = "\n".join([words(value), *([""] if constants else []), *constants])
        lines.append(f"\n### {module.__name__}.{node.name}\n" + block(heading(node), text))
        if not words(value):
            missing.append(f"{module.__name__}.{node.name}")
        if isinstance(node, ast.FunctionDef):
            continue
        for member in node.body:
            if not isinstance(member, ast.FunctionDef) or (member.name.startswith("__") and member.name != "__init__"):
                continue
            text = words(inspect.getattr_static(value, member.name)) or words(getattr(value, member.name))
            title = heading(member)
            lines.append(block(title.replace("__init__", node.name, 1) if member.name == "__init__" else title, text))
            if not text:
                missing.append(f"{module.__name__}.{node.name}.{member.name}")
    return lines


def main():
    missing = []
    pages = [page for module in (frontlux, frontlux.planner) for page in pages_of(module, missing)]
    if missing:
        sys.exit("these public names have no docstring: " + ", ".join(missing))
    pathlib.Path(sys.argv[1]).write_text(
        "# Python reference {#python_reference}\n\nMade from the docstrings, which `help(frontlux)` and `help(frontlux.planner)` show, "
        "too. Examples are in docs/python.md.\n" + "".join(pages), encoding="utf-8")


if __name__ == "__main__":
    main()
