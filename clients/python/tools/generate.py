#!/usr/bin/env python3
"""Writes revisit_slam/models.py and revisit_slam/operations.py from the API document.

`tools/generate.py` writes them; `tools/generate.py --check` only compares and exits 1 where they differ.
"""

from __future__ import annotations

import argparse
import keyword
import re
import sys
import textwrap
from itertools import zip_longest
from pathlib import Path
from typing import Any

import yaml

PACKAGE = Path(__file__).resolve().parents[1] / "revisit_slam"
DOCUMENT = Path(__file__).resolve().parents[3] / "openapi" / "openapi.yaml"
WIDTH = 110
# Written by hand in client.py and async_client.py: a body from a generator, a stream that resumes, and an answer that may be
# larger than memory.
BY_HAND = {"put_keyframes", "listen", "export_map"}
HEAD = '"""{title} Made from the API document by tools/generate.py: do not edit."""\n\nfrom __future__ import annotations\n\n'


def python_name(name: str) -> str:
    """Return `name` as a Python identifier that is no keyword."""
    plain = re.sub(r"\W", "_", name)
    return f"{plain}_" if keyword.iskeyword(plain) else plain


def camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def docstring(text: str, indent: int) -> str:
    """Return `text` as an indented docstring."""
    text = " ".join((text or "").split()).replace("\\", "\\\\").replace('"', "'")
    lines = textwrap.wrap(text, WIDTH - indent - 6) or ["Undocumented."]
    pad = " " * indent
    if len(lines) == 1:
        return f'{pad}"""{lines[0]}"""\n'
    return f'{pad}"""' + f"\n{pad}".join(lines) + f'\n{pad}"""\n'


def notes(schema: dict[str, Any]) -> tuple[str, list[str]]:
    """Return the note of an enumeration and those of its values; where these stand apart, the list in the note goes."""
    note, of_values = schema.get("description", ""), schema.get("x-enum-descriptions", [])
    return (note.split("\n\n")[0] if of_values else note), of_values


class Models:
    """The schemas of the document as msgspec structs and open enumerations."""

    def __init__(self, schemas: dict[str, Any]) -> None:
        self.schemas = schemas
        # The values, the note of the class, and a note for each value where the document has one.
        self.enums: dict[str, tuple[tuple[str, ...], str, list[str]]] = {}
        for name, schema in schemas.items():
            if "enum" in schema:
                self.enums[name] = (tuple(schema["enum"]), *notes(schema))

    def type_of(self, schema: dict[str, Any], owner: str, field: str) -> str:
        """Return the Python type of a schema; enumerations written in place get a name."""
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[-1]
            target = self.schemas[name]
            return name if "properties" in target or "enum" in target else self.type_of(target, owner, field)
        if "enum" in schema:
            return self.named(schema, owner, field)
        kinds = schema.get("type")
        if isinstance(kinds, list):
            inner = {**schema, "type": next(kind for kind in kinds if kind != "null")}
            return f"{self.type_of(inner, owner, field)} | None"
        if kinds == "array":
            return f"list[{self.type_of(schema['items'], owner, field)}]"
        if kinds == "object" and isinstance(schema.get("additionalProperties"), dict):
            return f"dict[str, {self.type_of(schema['additionalProperties'], owner, field)}]"
        return {"string": "str", "integer": "int", "number": "float", "boolean": "bool"}.get(kinds, "Any")

    def named(self, schema: dict[str, Any], owner: str, field: str) -> str:
        values = tuple(schema["enum"])
        for name, (others, *_) in self.enums.items():
            if others == values and name.endswith(camel(field)):
                return name
        name = owner + camel(field)
        self.enums[name] = (values, f"Values of `{field}` in {owner}.", notes(schema)[1])
        return name

    def struct(self, name: str, schema: dict[str, Any]) -> str:
        required = set(schema.get("required", []))
        first, then = [], []
        for field, inner in schema.get("properties", {}).items():
            hint, attribute = self.type_of(inner, name, field), python_name(field)
            renamed = attribute != field
            note = " ".join(inner.get("description", "").split())
            if field in required:
                default = f' = msgspec.field(name="{field}")' if renamed else ""
                first.append((f"    {attribute}: {hint}{default}\n", note))
            else:
                hint = hint if hint.endswith("None") or hint == "Any" else f"{hint} | None"
                default = f'msgspec.field(default=None, name="{field}")' if renamed else "None"
                then.append((f"    {attribute}: {hint} = {default}\n", note))
        body = "".join(line + (docstring(note, 4) if note else "") for line, note in first + then)
        head = f"class {name}(msgspec.Struct, kw_only=True, omit_defaults=True):\n"
        return head + docstring(schema.get("description", name), 4) + "\n" + (body or "    pass\n")

    def source(self) -> str:
        structs = [self.struct(name, schema) for name, schema in sorted(self.schemas.items()) if "properties" in schema]
        enums = []
        for name, (values, note, of_values) in sorted(self.enums.items()):
            members = ""
            for value, meaning in zip_longest(values, of_values, fillvalue=""):
                members += f'    {python_name(value).upper()} = "{value}"\n' + (docstring(meaning, 4) if meaning else "")
            enums.append(f"class {name}(OpenEnum):\n" + docstring(note, 4) + "\n" + members)
        imports = "from typing import Any\n\nimport msgspec\n\nfrom .open_enum import OpenEnum\n\n\n"
        return HEAD.format(title="Shapes of requests and answers.") + imports + "\n\n".join(enums + structs)


def operations(document: dict[str, Any], models: Models) -> str:
    """Return the source of the two classes with one method an operation."""
    plain, waiting = [], []
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            if operation["operationId"] in BY_HAND:
                continue
            plain.append(method_source(path, method, operation, models, ""))
            waiting.append(method_source(path, method, operation, models, "async "))
    imports = (
        "from collections.abc import Mapping\nfrom typing import Any\n\nfrom . import models\n"
        "from .call import Call, segment\nfrom .packing import packed\n\n\n"
    )
    base = "class {name}:\n    {note}\n\n    def _call(self, call: Call) -> Any:\n        raise NotImplementedError\n\n"
    return (
        HEAD.format(title="One method an operation.")
        + imports
        + base.format(name="Operations", note='"""Operations that block until they are answered."""')
        + "\n".join(plain)
        + "\n\n"
        + base.replace("    def _call", "    async def _call").format(
            name="AsyncOperations", note='"""Operations to be awaited."""'
        )
        + "\n".join(waiting)
    )


def method_source(path: str, verb: str, operation: dict[str, Any], models: Models, prefix: str) -> str:
    name = operation["operationId"]
    positional, keywords, query, headers = ["self"], [], [], []
    url = path
    for parameter in operation.get("parameters", []):
        raw, attribute = parameter["name"], python_name(parameter["name"])
        hint = models.type_of(parameter["schema"], camel(name), raw)
        hint = hint if hint in ("str", "int", "float", "bool") else "str"
        if parameter["in"] == "path":
            positional.append(f"{attribute}: {hint}")
            url = url.replace("{" + raw + "}", "{segment(" + attribute + ")}")
            continue
        keywords.append(f"{attribute}: {hint}" if parameter.get("required") else f"{attribute}: {hint} | None = None")
        (query if parameter["in"] == "query" else headers).append(f'"{raw}": {attribute}')
    arguments = [f'"{verb.upper()}"', f'f"{url}"' if "{segment" in url else f'"{url}"']
    if query:
        arguments.append("query={" + ", ".join(query) + "}")
    if headers:
        arguments.append("headers={" + ", ".join(headers) + "}")
    if "requestBody" in operation:
        schema = operation["requestBody"]["content"]["application/json"]["schema"]["$ref"].rsplit("/", 1)[-1]
        positional.append(f"body: models.{schema} | Mapping[str, Any]")
        # A keyframe with long columns is a third smaller and read in a fraction of the time when they are packed.
        arguments.append("body=packed(body)" if schema == "Keyframe" else "body=body")
    answer, hint = answer_of(operation)
    if answer:
        arguments.append(f"answer={answer}")
    signature = ", ".join(positional + (["*"] + keywords if keywords else []))
    note = f"{operation.get('summary', '')}. {operation.get('description', '')}".replace("?.", "?")
    head = f"    {prefix}def {name}({signature}) -> {hint}:\n"
    wait = "await " if prefix else ""
    call = ", ".join(arguments)
    return head + docstring(note, 8) + f"        return {wait}self._call(Call({call}))\n"


def answer_of(operation: dict[str, Any]) -> tuple[str, str]:
    """Return how an answer is decoded, and its type for readers."""
    for code, response in operation["responses"].items():
        for kind, content in response.get("content", {}).items() if code.startswith("2") else ():
            schema = content.get("schema", {})
            if kind == "application/json" and "$ref" in schema:
                name = "models." + schema["$ref"].rsplit("/", 1)[-1]
                return name, name
            if kind == "application/json":
                return "dict", "dict[str, Any]"
            return ("bytes", "bytes") if kind.startswith("image/") else ("str", "str")
    return "", "None"


def main() -> int:
    """Write the two files, or compare them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare only; exit 1 where the files differ")
    parser.add_argument("--document", type=Path, default=DOCUMENT)
    chosen = parser.parse_args()
    document = yaml.safe_load(chosen.document.read_text())
    models = Models(document["components"]["schemas"])
    sources = {"models.py": models.source(), "operations.py": operations(document, models)}
    stale = []
    for name, source in sources.items():
        target = PACKAGE / name
        if chosen.check:
            if not target.exists() or target.read_text() != source:
                stale.append(name)
        else:
            target.write_text(source)
    if stale:
        print(f"differ from the API document: {', '.join(stale)}; if it is meant: tools/generate.py", file=sys.stderr)
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
