"""The public names of a module against its type stub."""
import ast
import inspect
import pathlib
import types


def expect_documented_and_typed(test, module, borrowed=()):
    """All names of a module but the borrowed ones have a docstring, and a type in its stub with the same arguments."""
    stub = ast.parse((pathlib.Path(module.__file__).parent / "__init__.pyi").read_text())
    typed = {node.name: node for node in stub.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    public = {name for name, value in vars(module).items()
              if not name.startswith("_") and name not in borrowed and not isinstance(value, types.ModuleType)}
    test.assertEqual(set(typed), public)
    for name in public:
        value = getattr(module, name)
        test.assertTrue(value.__doc__, name)
        if isinstance(typed[name], ast.FunctionDef):
            _expect_arguments(test, value, typed[name])
            continue
        members = {node.name: node for node in typed[name].body if isinstance(node, ast.FunctionDef)}
        own = {n for n, v in vars(value).items()
               if not n.startswith("_") and (callable(v) or isinstance(v, (property, staticmethod)))}
        if not issubclass(value, int):
            test.assertEqual({n for n in members if not n.startswith("_")}, own, name)
        for member, node in members.items():
            test.assertTrue(getattr(value, member).__doc__, f"{name}.{member}")
            if not node.decorator_list or node.decorator_list[0].id == "staticmethod":
                _expect_arguments(test, getattr(value, member), node)


def _expect_arguments(test, function, node):
    """pybind11 writes the signature into the docstring's first line."""
    if node.name in ("__eq__", "__len__", "__copy__", "__deepcopy__"):
        return
    names = [argument.arg for argument in node.args.args]
    optional = [False] * (len(names) - len(node.args.defaults)) + [True] * len(node.args.defaults)
    if inspect.isfunction(function):
        parameters = inspect.signature(function).parameters
        test.assertEqual(names, list(parameters), function)
        test.assertEqual(optional, [p.default is not p.empty for p in parameters.values()], function)
        return
    signature = function.__doc__.split("\n")[0]
    documented = ast.parse("def f" + signature[signature.index("("):signature.rindex(" ->")] + ": ...").body[0].args
    test.assertEqual(names, [a.arg for a in documented.args], signature)
    test.assertEqual(sum(optional), len(documented.defaults), signature)
