"""Write the JSON Schemas of trial files and results from the code that reads and writes them."""

import json
from pathlib import Path

from seatrial.control.loopfile.schema import loop_schema
from seatrial.data.folder.design_json import design_schema
from seatrial.data.folder.fit_json import fit_schema
from seatrial.data.folder.online_json import online_schema
from seatrial.data.folder.tuning_json import tuning_schema
from seatrial.data.trial.schema import trial_schema

if __name__ == "__main__":
    schemas = {
        "design": design_schema(),
        "loop": loop_schema(),
        "online": online_schema(),
        "result": fit_schema(),
        "trial": trial_schema(),
        "tuning": tuning_schema(),
    }
    for name, schema in schemas.items():
        path = Path(__file__).with_name(f"{name}.schema.json")
        path.write_text(json.dumps(schema, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
