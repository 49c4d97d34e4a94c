"""A design search: screened by the thousand, corrected, solved, proposed anew, and judged."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError, WorkersError
from squeezefilm.core.hard_limits import DESIGNS_SCREENED, DESIGNS_SOLVED
from squeezefilm.core.progress import SayProgress, about
from squeezefilm.core.results import config_hash, stamp
from squeezefilm.design.search import worth_solving as choice
from squeezefilm.design.search.candidate import (
    Design,
    Evaluated,
    Level,
    at_other_voltages,
    design_of,
    evaluate_all,
    not_evaluated,
    plates_of,
    reference_of,
)
from squeezefilm.design.search.evolution import POPULATION, Proposals
from squeezefilm.design.search.found import DesignSearch, FrontMember
from squeezefilm.design.search.limits import Made, made_of
from squeezefilm.design.search.requirements import NamedRequirements
from squeezefilm.design.search.space import Space
from squeezefilm.design.search.store import DesignStore
from squeezefilm.design.sweep.tasks import NoAnswer, Workers
from squeezefilm.design.sweep.tradeoffs import front_of
from squeezefilm.design.sweep.workers import workers

# Screened designs to a task: one takes some ten milliseconds.
_TOGETHER = 8
_BATCH = 16
# The share of the plates to solve that the Bayesian sampler proposes, where there are enough for it
# to learn from: of nine it learns nothing, and proposes plates anywhere.
_BY_SAMPLER, _ENOUGH_FOR_SAMPLER = 0.25, 40
# Designs near each of so many of the front, and as many expected there, that are screened in each
# of some generations before the next are solved.
_NEAR, _FROM, _GENERATIONS = 8, 12, 3


@si.checked_numbers
@dataclass(frozen=True)
class SearchRequest:
    """Arguments of `search_designs`."""

    requirements: NamedRequirements
    _: KW_ONLY
    screened: Annotated[int, DESIGNS_SCREENED] = 2000
    solved: Annotated[int, DESIGNS_SOLVED] = 120
    seed: Annotated[int, si.AtLeast(0)] = 1
    jobs: Annotated[int, si.AtLeast(1)] = 1
    scheduler: str | None = None
    out: str | Path | None = None
    member: Annotated[int, si.AtLeast(0)] = 0
    progress: SayProgress | None = None
    watch: Callable[[DesignSearch], None] | None = None


@reads_text
@called_with(SearchRequest)
def search_designs(asked: SearchRequest) -> DesignSearch:
    """The plates that meet requirements and that none other beats, solved in three dimensions.

    Args:
        requirements: what is asked of a display; a preset's name, or a TOML file.
        screened: designs that are looked at by the screening theory before any is solved; beside
            the front some hundreds more are, between one batch of solved plates and the next.
        solved: plates that are solved in three dimensions, at most; each is judged at voltages
            from the least to the most.
        seed: of everything that is drawn.
        jobs: processes; more than one in a script needs ``if __name__ == "__main__":``.
        scheduler: of a Dask cluster that computes in place of processes, "tcp://host:8786".
        out: a folder that keeps every design as it comes, and has those of before.
        member: of several hosts that search in one folder at once, each has a number of its own:
            0, 1, … They learn from each other, and each ends with what all have solved.
        progress: is told what is being done, and how long it takes.
        watch: is shown what there is after every batch.

    Raises `InputError` before anything is computed for requirements that contradict themselves,
    and where none of the screened designs can be built.
    """
    run = SearchRun(asked)
    run.finish()
    return run.result()


def search_until_stopped(asked: SearchRequest) -> tuple[DesignSearch, str]:
    """A search that Ctrl-C or the end of a cluster stops, with what was found until then, and what
    stopped it (empty where nothing did). Raises as `search_designs`, and `WorkersError` where a
    cluster cannot be used from the beginning."""
    run = SearchRun(asked)
    stopped = ""
    try:
        run.finish()
    except KeyboardInterrupt:
        stopped = "stopped"
    except WorkersError as error:
        search = run.result()
        if not search.screened:
            raise
        return search, str(error)
    return run.result(), stopped


class SearchRun:
    """A search under way: what it knows, and what it does next."""

    def __init__(self, asked: SearchRequest) -> None:
        self._asked, self.requirements = asked, asked.requirements
        folder = None if asked.out is None else Path(asked.out)
        self._store = DesignStore(self.requirements, folder, asked.member)
        self._tell = asked.progress or (lambda _: None)
        self._made: dict[Design, Made] = {}
        self._reference: Evaluated | None = None
        self._corrections: list[choice.Correction | None] = [None] * len(self.requirements.spaces)
        self._seen: dict[Level, dict[Design, Evaluated]] = {"screened": {}, "solved": {}}
        self._began, self._done = time.monotonic(), False
        self._stage, self._left, self._shown_next = "", "", 0.0

    def finish(self) -> None:
        """All that is left to do. What came is kept where this is interrupted."""
        asked = self._asked
        with workers(
            jobs=asked.jobs, scheduler=asked.scheduler, tell=self._tell, first=evaluate_all
        ) as pool:
            if self.requirements.compare_with:
                self._tell(f"{self.requirements.compare_with}, to compare with")
                self._reference = reference_of(self.requirements)
            self._screen(pool)
            every = asked.solved
            if every >= _ENOUGH_FOR_SAMPLER:
                self._solve_the_best(pool, every - round(_BY_SAMPLER * every))
                self._propose(pool)
            self._solve_the_best(pool, every)
            self._learn()
            # Only now: what is proposed and solved here depends on the seed alone.
            for shape in range(len(self.requirements.spaces)):
                others = self._store.of_others(shape, "solved")
                self._seen["solved"].update((other.design, other) for other in others)
            self._make(pool)
        self._done = True

    def _screen(self, pool: Workers) -> None:
        spaces = self.requirements.spaces
        share = -(-self._asked.screened // len(spaces))
        begun = time.monotonic()
        for shape, space in enumerate(spaces):
            proposals = self._proposals(shape, "screened")
            size = min(POPULATION, share)
            for batch in range(-(-share // size)):
                self._say_screening(space.shape, shape * share + batch * size, begun)
                others = self._store.of_others(shape, "screened")
                asked = proposals.ask(min(size, share - batch * size), batch, others)
                screened = self._evaluated(pool, [design for _, design in asked], "screened")
                proposals.tell([(trial, screened[design]) for trial, design in asked])
                self._show()
        if all(candidate.reason for candidate in self._seen["screened"].values()):
            first = next(iter(self._seen["screened"].values()))
            raise InputError(
                f"none of the screened designs can be built, for example: {first.reason}"
            )

    def _say_screening(self, shape: str, done: int, begun: float) -> None:
        self._stage, self._left, every = f"screening {shape}", "", self._asked.screened
        if done:
            seconds = (time.monotonic() - begun) / done * (every - done)
            self._left = about(max(seconds, 0.0))
        left = self._left and f", {self._left} left"
        feasible = sum(candidate.is_feasible for candidate in self._seen["screened"].values())
        self._tell(f"screening {shape}: {done} of {every} designs, {feasible} feasible{left}")

    def _proposals(self, shape: int, level: Level) -> Proposals:
        return Proposals(
            self.requirements, shape, level, self._asked.seed, member=self._asked.member
        )

    def _solve_the_best(self, pool: Workers, most: int) -> None:
        """Solve the designs that the screening, corrected by what was solved, takes for the best,
        until none is left that might enter the front, or `most` plates are solved."""
        while (left := most - len(self._plates_solved())) > 0:
            self._learn()
            self._screen_beside_the_front(pool)
            # Of few plates half are chosen by what the first half corrects.
            first = max(choice.LEAST_PLATES, left // 2) if left == most else left
            count = min(_BATCH, first, left)
            chosen = choice.worth_solving(self.requirements, self._seen, self._corrections, count)
            if not chosen:
                return
            self._say_solving("the best that were screened")
            self._solve(pool, chosen)
            self._show()

    def _plates_solved(self) -> Mapping[Design, tuple[Design, ...]]:
        return plates_of(self._seen["solved"])

    def _solve(self, pool: Workers, designs: Iterable[Design]) -> Mapping[Design, Evaluated]:
        """Solve designs, and judge their plates at other voltages, too."""
        asked = list[Design]()
        for design in designs:
            asked += (design, *at_other_voltages(self.requirements, design))
        return self._evaluated(pool, asked, "solved")

    def _screen_beside_the_front(self, pool: Workers) -> None:
        """Look by the screening theory at what differs a little from the solved front, and from
        what is expected on it, some generations on: there the correction is best, and limits can be
        met to the point."""
        front, solved = self._front(), self._seen["solved"]
        if not front:
            return  # what is expected before any plate kept the limits lies beyond them
        rows = choice.objectives_of(self.requirements, front)
        # Always from the ends of the front, which decide what it dominates.
        ends = [front[k].design for k in np.argmin(rows, axis=0)]
        self._screen_near(pool, ends, Space.beside)
        draw = np.random.default_rng([self._asked.seed, self._asked.member, len(solved)])
        for _ in range(_GENERATIONS):
            plates = plates_of(front[k].design for k in draw.permutation(len(front)))
            known = [plate[-1] for plate in plates.values()][:_FROM]
            expected = choice.worth_solving(self.requirements, self._seen, self._corrections, _FROM)
            self._screen_near(
                pool,
                (*ends, *known, *expected),
                lambda space, here: [space.moved(here, draw) for _ in range(_NEAR)],
            )

    def _screen_near(
        self,
        pool: Workers,
        designs: Iterable[Design],
        near: Callable[[Space, Mapping[str, float]], Iterable[Mapping[str, float]]],
    ) -> None:
        """Screen what lies near designs, by places that their space gives."""
        beside, solved = list[Design](), self._plates_solved()
        for design in designs:
            space = self.requirements.spaces[design.shape]
            places = near(space, space.places(design.settings))
            beside += [design_of(design.shape, space.at(there)) for there in places]
        self._evaluated(
            pool, [design for design in beside if design.plate not in solved], "screened"
        )

    def _learn(self) -> None:
        solved = list(self._seen["solved"].values())
        for shape, space in enumerate(self.requirements.spaces):
            here = [solution for solution in solved if solution.design.shape == shape]
            self._corrections[shape] = choice.learned(space, self._seen["screened"], here)

    def _propose(self, pool: Workers) -> None:
        """Let a Bayesian sampler propose plates beside the front, and solve them."""
        solved = self._seen["solved"]
        shapes = sorted({candidate.design.shape for candidate in self._front()})
        batch = 0
        studies = {}
        for shape in shapes:
            studies[shape] = self._proposals(shape, "solved")
            studies[shape].known(
                [solution for solution in solved.values() if solution.design.shape == shape]
            )
        while shapes and (before := len(self._plates_solved())) < self._asked.solved:
            for shape in shapes:
                left = self._asked.solved - len(self._plates_solved())
                count = min(_BATCH // len(shapes) or 1, left)
                if count <= 0:
                    break
                self._say_solving("what lies beside the front")
                others = self._store.of_others(shape, "solved")
                asked = studies[shape].ask(count, batch, others)
                fresh = list(dict.fromkeys(design for _, design in asked))
                # Where it lies beside its screened number is asked, too.
                self._evaluated(pool, fresh, "screened")
                solutions = self._solve(pool, fresh)
                studies[shape].tell([(trial, solutions[design]) for trial, design in asked])
                self._show()
            batch += 1
            if len(self._plates_solved()) == before:
                break  # it proposes nothing new

    def _say_solving(self, what: str) -> None:
        self._stage, self._left, solved = f"solving {what}", "", len(self._plates_solved())
        # Nobody knows how many workers a cluster has.
        if solved and self._asked.scheduler is None:
            took = sum(candidate.seconds for candidate in self._seen["solved"].values()) / solved
            rest = (self._asked.solved - solved) * took / self._asked.jobs
            self._left = about(rest)
        left = self._left and f", {self._left} left at most"
        on_front = len(plates_of(evaluated.design for evaluated in self._front()))
        self._tell(
            f"solving {what}: {solved} of at most {self._asked.solved} plates, "
            f"{on_front} on the front{left}"
        )

    def _make(self, pool: Workers) -> None:
        """Draw what is made of the front's drawings; where a yield is asked for, leave out what
        misses it, and draw what comes to the front in its place."""
        asked: set[Design] = set()
        while front := [candidate for candidate in self._front() if candidate.design not in asked]:
            asked.update(candidate.design for candidate in front)
            kept = ((candidate.design, self._store.made(candidate.design)) for candidate in front)
            self._made.update((design, made) for design, made in kept if made is not None)
            tasks = {o.design: (self.requirements, o) for o in front if o.design not in self._made}
            for done, (design, made) in enumerate(pool.answers(made_of, tasks)):
                if not isinstance(made, NoAnswer):
                    self._made[design] = made
                    self._store.add_made(design, made)
                self._tell(f"plates made with the tolerances: {done + 1} of {len(tasks)} drawings")

    def _evaluated(
        self, pool: Workers, designs: Sequence[Design], level: Level
    ) -> Mapping[Design, Evaluated]:
        """Designs at a level, kept ones as they are."""
        evaluated: dict[Design, Evaluated] = {}
        missing: dict[Design, None] = {}
        for design in designs:
            known = self._store.get(design, level)
            if known is None:
                missing[design] = None
            else:
                evaluated[design] = known
        each = tuple(missing)
        parts = [each[begin : begin + _TOGETHER] for begin in range(0, len(each), _TOGETHER)]
        if level == "solved":
            parts = list(plates_of(each).values())
        tasks = {number: (self.requirements, part, level) for number, part in enumerate(parts)}
        try:
            for number, answers in pool.answers(evaluate_all, tasks):
                if isinstance(answers, NoAnswer):
                    answers = [not_evaluated(design, level, answers) for design in parts[number]]
                self._store.add(answers)
                evaluated.update((answer.design, answer) for answer in answers)
                self._show_meanwhile(level, evaluated)
        finally:
            # What came before Ctrl-C is shown, too.
            came = [design for design in designs if design in evaluated]
            self._seen[level].update((design, evaluated[design]) for design in came)
        return evaluated

    def _front(self, seen: choice.Seen | None = None) -> list[Evaluated]:
        """The feasible solved designs that none other beats, the first objective rising; without
        those of which, as made, fewer keep the limits than are wanted."""
        wanted, made = self.requirements.limits.least_yield or 0.0, self._made
        feasible = [
            solution
            for solution in (seen or self._seen)["solved"].values()
            if solution.is_feasible
            and (solution.design not in made or made[solution.design].kept >= wanted)
        ]
        rows = choice.objectives_of(self.requirements, feasible)
        return [feasible[k] for k in sorted(front_of(rows), key=lambda k: tuple(rows[k]))]

    def _show_meanwhile(self, level: Level, evaluated: Mapping[Design, Evaluated]) -> None:
        """Show what came in the middle of a batch, so seldom that it takes little of the time."""
        now = time.monotonic()
        if self._asked.watch is None or now < self._shown_next:
            return
        self._show({**self._seen, level: {**self._seen[level], **evaluated}})
        self._shown_next = time.monotonic() + max(1.0, 20 * (time.monotonic() - now))

    def _show(self, seen: choice.Seen | None = None) -> None:
        """Show what was seen, if anybody watches."""
        if self._asked.watch is not None:
            self._asked.watch(self.result(seen))

    def result(self, seen: choice.Seen | None = None) -> DesignSearch:
        """Result until now, of all that was seen or of a part of it."""
        seen, requirements = seen or self._seen, self.requirements
        screened, solved = tuple(seen["screened"].values()), tuple(seen["solved"].values())
        return DesignSearch(
            requirements=requirements,
            seed=self._asked.seed,
            screened=screened,
            solved=solved,
            front=tuple(
                FrontMember(evaluated, self._made.get(evaluated.design))
                for evaluated in self._front(seen)
            ),
            reference=self._reference,
            corrections=tuple(self._corrections),
            computed=self._store.computed,
            kept=len(screened) + len(solved) - self._store.computed,
            seconds=time.monotonic() - self._began,
            stopped=not self._done,
            provenance=stamp(requirements.base, self._asked.seed)
            | {"requirements_sha256": config_hash(requirements)},
            stage=self._stage,
            left=self._left,
        )
