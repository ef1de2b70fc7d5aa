"""Write the JSON Schemas of trial files and results from the code that reads and writes them."""

import json
from pathlib import Path

from seatrial.trial.design_json import design_schema
from seatrial.trial.fit_json import fit_schema
from seatrial.trial.online_json import online_schema
from seatrial.trial.schema import trial_schema
from seatrial.trial.tuning_json import tuning_schema
from seatrial.tune.loopfile.schema import loop_schema

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
