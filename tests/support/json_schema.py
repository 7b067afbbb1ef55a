"""Whether a value has the form of one of the repository's JSON schemas."""
import json
import pathlib

import jsonschema

ROOT = pathlib.Path(__file__).resolve().parents[2]


def faults_of(value, schema):
    """The places and reasons, none for a value of that form. `schema` is a path in the repository."""
    files = {path.name: json.loads(path.read_text()) for path in (ROOT / "miniapp").glob("*/*.schema.json")}
    resolver = jsonschema.RefResolver("", files[pathlib.Path(schema).name], store=files)
    validator = jsonschema.Draft202012Validator(files[pathlib.Path(schema).name], resolver=resolver)
    return ["/".join(map(str, fault.absolute_path)) + ": " + fault.message for fault in validator.iter_errors(value)]
