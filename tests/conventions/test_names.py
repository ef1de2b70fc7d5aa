"""Names say what they stand for: public class names are unique, and none is a word that names nothing."""

import ast
from collections import Counter, defaultdict

from tests.conventions.source_tree import PACKAGES, SourceFile, functions, parameters, source_files

# Participles and particles: as a name each leaves open what was made, found or taken.
EMPTY_WORDS = frozenset(
    "made found known told seen said own others at of what how begin whole left taken drawn shown".split()  # noqa: SIM905
)


# As a variable each of these leaves open what it is, too.
EMPTY_VARIABLES = EMPTY_WORDS | frozenset("begun shot some lost one met".split())  # noqa: SIM905

# Folders whose variables are not counted yet.
NOT_BEGUN = ("estimation/estimate", "estimation/identify")
# Folder -> how many of its variables are still such words. It may only fall.
VARIABLES: dict[str, int] = {
    "seatrial/api": 13,
    "seatrial/campaigns": 13,
    "seatrial/cli": 15,
    "seatrial/control": 174,
    "seatrial/control/loopfile": 30,
    "seatrial/data/check": 41,
    "seatrial/data/draft": 152,
    "seatrial/data/folder": 1,
    "seatrial/data/read": 35,
    "seatrial/data/read/formats": 5,
    "seatrial/estimation/design": 20,
    "seatrial/estimation/information": 43,
    "seatrial/estimation/predict": 28,
    "seatrial/estimation/problem": 33,
    "seatrial/estimation/regress": 31,
    "seatrial/estimation/sea": 7,
    "seatrial/numerics/kernels": 26,
    "seatrial/numerics/optimise": 12,
    "seatrial/onboard": 14,
    "seatrial/physics/loops": 61,
    "seatrial/physics/manoeuvres": 21,
    "seatrial/physics/sea": 13,
    "seatrial/physics/sensors": 1,
    "seatrial/physics/simulate": 49,
    "seatrial/problems": 2,
    "seatrial/reporting": 57,
    "seatrial/reporting/figures": 10,
    "seatrial_studies": 12,
    "seatrial_studies/alexandersson2022": 14,
    "seatrial_studies/meng2014": 9,
    "seatrial_studies/qi2025": 15,
    "seatrial_studies/section2d": 27,
    "seatrial_studies/song2025": 24,
    "seatrial_studies/yu2014": 39,
}

# In figures `left` is a side, next to `right` and `top`.
SIDES = ("left",)


def _files() -> list[SourceFile]:
    return [file for package in PACKAGES for file in source_files(package)]


def test_a_public_class_name_stands_for_one_thing() -> None:
    places: dict[str, list[str]] = defaultdict(list)
    for file in _files():
        for node in file.nodes:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(file.place(node))
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


def test_no_class_function_attribute_or_parameter_is_a_word_that_names_nothing() -> None:
    empty = [
        f"{place} {name}"
        for file in _files()
        for place, name in _declared(file)
        if _is_empty(name) and not _is_side(file, name)
    ]
    assert empty == []


def test_no_module_is_a_word_that_names_nothing() -> None:
    assert [str(file.path) for file in _files() if _is_empty(file.path.stem)] == []


def test_fewer_and_fewer_variables_are_words_that_name_nothing() -> None:
    """Folders that are done stand in no list; the numbers of the others may only fall."""
    present = Counter(folder for folder, _ in _empty_variables())
    above = [place for folder, place in _empty_variables() if present[folder] > VARIABLES.get(folder, 0)]
    assert above == [], "give these variables, or others of their folder, the noun of the field"
    assert [folder for folder in VARIABLES if not present[folder]] == [], "done by now: strike them from VARIABLES"


def _empty_variables() -> list[tuple[str, str]]:
    """Return folder and place of every variable, and argument of a lambda, that is a word that names nothing."""
    stored = [(file, n, n.id) for file in _files() for n in file.nodes
              if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]  # fmt: skip
    stored += [(file, a, a.arg) for file in _files() for n in file.nodes if isinstance(n, ast.Lambda)
               for a in n.args.args]  # fmt: skip
    return [
        ("/".join(filter(None, (file.path.relative_to(file.root).parts[0], file.folder))), file.place(node))
        for file, node, name in stored
        if name in EMPTY_VARIABLES and not _is_side(file, name) and not file.folder.startswith(NOT_BEGUN)
    ]


def _is_side(file: SourceFile, name: str) -> bool:
    return name in SIDES and "figures" in file.folder


def _is_empty(name: str) -> bool:
    return name.strip("_").lower() in EMPTY_WORDS


def _declared(file: SourceFile) -> list[tuple[str, str]]:
    """Return place and name of everything a file declares for others to read."""
    declared = [(file.place(f), f.name) for f in functions(file.tree)]
    declared += [(file.place(a), a.arg) for f in functions(file.tree) for a in parameters(f)]
    for node in file.nodes:
        if isinstance(node, ast.ClassDef):
            declared.append((file.place(node), node.name))
            declared += [
                (file.place(field), field.target.id)
                for field in node.body
                if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)
            ]
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            declared.append((file.place(node), node.attr))
    return declared
