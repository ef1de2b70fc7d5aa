"""Names of this package, imported when first used."""

from seatrial.problems.method import AskTell as AskTell, MethodError as MethodError
from seatrial.problems.attempt import Answer as Answer, attempt as attempt, repeats_itself as repeats_itself
from seatrial.problems.attempt import suits as suits
from seatrial.problems.problem import Estimate as Estimate
from seatrial.problems.method import EnteredMethod as EnteredMethod, built_in_methods as built_in_methods
from seatrial.problems.method import entered_method as entered_method, method_named as method_named
from seatrial.problems.trial_problem import centred_box as centred_box, off_centre_box as off_centre_box
from seatrial.problems.trial_problem import scaled_values as scaled_values
from seatrial.problems.trial_problem import (
    standard_errors_within as standard_errors_within,
    start_within as start_within,
)
from seatrial.problems.trial_problem import fold_draw as fold_draw
from seatrial.problems.problem import BudgetSpent as BudgetSpent, PosedProblem as PosedProblem
from seatrial.problems.problem import BenchmarkProblem as BenchmarkProblem, PaperClaim as PaperClaim
from seatrial.problems.problem import Placement as Placement
from seatrial.problems.problem import ProblemDraw as ProblemDraw
from seatrial.problems.problem import absent_families as absent_families
from seatrial.problems.problem import list_problems as list_problems, problem_named as problem_named
from seatrial.problems.problem import problems_matching as problems_matching
from seatrial.problems.problem import KnownOptimum as KnownOptimum, KnownTruth as KnownTruth
from seatrial.problems.problem import Yardstick as Yardstick
