"""The operations of the API document, and every list in the bodies that they take."""

import re

METHODS = {"get", "put", "post", "patch", "delete"}
# A list of at most this many entries is a pair, a box or a vector: it does not grow.
VECTOR = 4
# A column of numbers as one text: a list, too.
PACKED = re.compile(r"_(i64|u32|f32|f64)$")


def resolved(document, schema):
    """A schema with what its reference says."""
    while "$ref" in schema:
        target = document
        for part in schema["$ref"].split("/")[1:]:
            target = target[part]
        schema = target | {key: value for key, value in schema.items() if key != "$ref"}
    return schema


def lists(document, schema, path="", above=()):
    """Each list below a schema, by its path, with the most entries that it may have; vectors are left out."""
    above = (*above, schema.get("$ref"))
    schema = resolved(document, schema)
    for part in (one for kind in ("allOf", "oneOf", "anyOf") for one in schema.get(kind, [])):
        yield from lists(document, part, path, above)
    if "array" in schema.get("type", ""):
        if schema.get("maxItems", VECTOR + 1) > VECTOR:
            yield path, schema.get("maxItems")
        yield from lists(document, schema.get("items", {}), f"{path}[]", above)
    inner = dict(schema.get("properties", {}))
    if isinstance(schema.get("additionalProperties"), dict):
        inner["*"] = schema["additionalProperties"]
        yield f"{path}.*".lstrip("."), schema.get("maxProperties")
    for name, value in inner.items():
        if value.get("$ref") is not None and value["$ref"] in above:
            continue
        below = f"{path}.{name}".lstrip(".")
        if PACKED.search(name) or "in base64" in resolved(document, value).get("description", ""):
            yield below, resolved(document, value).get("maxLength")
        yield from lists(document, value, below, above)


def operations(document):
    """Each operation by its id: its method, its path, and its lists with their maxima."""
    found = {}
    for path, item in document["paths"].items():
        for method, operation in item.items():
            if method not in METHODS:
                continue
            of = {}
            for content in operation.get("requestBody", {}).get("content", {}).values():
                of |= dict(lists(document, content.get("schema", {})))
            found[operation["operationId"]] = (method.upper(), path, of)
    return found
