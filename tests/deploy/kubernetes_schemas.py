"""Strict JSON schemas for kubeconform, from what Kubernetes and other projects publish: a field that is not described is an error,
and so is null. Usage: kubernetes_schemas.py OUT SWAGGER CRD... (OpenAPI 2 of Kubernetes, files of CustomResourceDefinitions)."""

from __future__ import annotations

import json
import pathlib
import sys
from collections.abc import Iterator
from typing import Any

import yaml

#: Of a schema of OpenAPI, what JSON Schema knows as well. Formats are not among them: JSON Schema has others.
KEPT = {
    *("type", "required", "enum", "pattern", "minimum", "maximum", "minLength", "maxLength", "minItems", "maxItems", "uniqueItems"),
    *("minProperties", "maxProperties"),
}
QUANTITY = "io.k8s.apimachinery.pkg.api.resource.Quantity"
INT_OR_STRING = {"type": ["integer", "string"]}


def strict(schema: dict[str, Any]) -> dict[str, Any]:
    """The same schema, without fields that it does not name."""
    if "$ref" in schema:
        return {"$ref": schema["$ref"]}
    if schema.get("x-kubernetes-int-or-string") or schema.get("format") == "int-or-string":
        return dict(INT_OR_STRING)
    result: dict[str, Any] = {key: value for key, value in schema.items() if key in KEPT}
    for key in ("allOf", "anyOf", "oneOf"):
        # Within these a project says more of an object that is described around them.
        if key in schema:
            result[key] = [{name: value for name, value in part.items() if name in KEPT} for part in schema[key]]
    if "items" in schema:
        result["items"] = strict(schema["items"])
    if "properties" in schema:
        result["properties"] = {name: strict(value) for name, value in schema["properties"].items()}
        result["additionalProperties"] = bool(schema.get("x-kubernetes-preserve-unknown-fields"))
    if isinstance(schema.get("additionalProperties"), dict):
        result["additionalProperties"] = strict(schema["additionalProperties"])
    return result


def references(schema: Any) -> Iterator[str]:
    if isinstance(schema, dict):
        for key, value in schema.items():
            if key == "$ref" and isinstance(value, str):  # it is a field of some schemas too
                yield value.removeprefix("#/definitions/")
            else:
                yield from references(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from references(value)


def top(schema: dict[str, Any], group: str, version: str, kind: str) -> dict[str, Any]:
    """The schema of a whole document."""
    properties = {**schema.get("properties", {}), "kind": {"const": kind}}
    properties["apiVersion"] = {"const": f"{group}/{version}" if group else version}
    required = {*schema.get("required", []), "apiVersion", "kind", "metadata"}
    return {**schema, "properties": properties, "required": sorted(required)}


def from_swagger(path: pathlib.Path) -> Iterator[tuple[tuple[str, str, str], dict[str, Any]]]:
    published = json.loads(path.read_text())["definitions"]
    definitions = {name: strict(schema) for name, schema in published.items()}
    definitions[QUANTITY] = {"type": ["string", "number"], "pattern": r"^[0-9]+(\.[0-9]+)?(m|[kMGTPE]|[KMGTPE]i)?$"}
    for name, schema in published.items():
        kinds = schema.get("x-kubernetes-group-version-kind", [])
        if len(kinds) != 1 or "metadata" not in schema.get("properties", {}):
            continue
        used: set[str] = set()
        open_names = list(references(definitions[name]))
        while open_names:
            found = open_names.pop()
            if found not in used:
                used.add(found)
                open_names += references(definitions[found])
        place = (kinds[0]["group"], kinds[0]["version"], kinds[0]["kind"])
        yield place, {**top(definitions[name], *place), "definitions": {found: definitions[found] for found in sorted(used)}}


def from_definitions(path: pathlib.Path, metadata: dict[str, Any]) -> Iterator[tuple[tuple[str, str, str], dict[str, Any]]]:
    """`metadata`: of every object, which definitions of custom resources leave to Kubernetes."""
    # Some are templates of a chart, within one condition.
    text = "\n".join(line for line in path.read_text().splitlines() if not line.startswith("{{"))
    for document in yaml.load_all(text, yaml.CSafeLoader):
        if not document or document.get("kind") != "CustomResourceDefinition":
            continue
        spec = document["spec"]
        for version in spec["versions"]:
            place = (spec["group"], version["name"], spec["names"]["kind"])
            schema = strict(version["schema"]["openAPIV3Schema"])
            schema["properties"]["metadata"] = {"$ref": metadata["$ref"]}
            yield place, {**top(schema, *place), "definitions": metadata["definitions"]}


def main(out: pathlib.Path, swagger: pathlib.Path, definitions: list[pathlib.Path]) -> None:
    schemas = dict(from_swagger(swagger))
    some = schemas["apps", "v1", "Deployment"]
    metadata = {"$ref": some["properties"]["metadata"]["$ref"], "definitions": some["definitions"]}
    for path in definitions:
        schemas.update(from_definitions(path, metadata))
    out.mkdir(parents=True, exist_ok=True)
    for (group, version, kind), schema in schemas.items():
        # As kubeconform names them: {{.ResourceKind}}{{.KindSuffix}}.json
        suffix = f"-{group.split('.')[0]}-{version}" if group else f"-{version}"
        (out / f"{kind.lower()}{suffix}.json").write_text(json.dumps(schema))
    print(f"{len(schemas)} kinds in {out}")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), [pathlib.Path(name) for name in sys.argv[3:]])
