# SPDX-License-Identifier: BSD-3-Clause
"""Proves an answer of `conus plan --needles` again, from its rows, its sidecar and --candidates alone (Eq. 25 to 28).

It measures the pairs of candidates anew, and looks through all combinations of them for a better one, with bounds of
its own. It believes how many candidates are not below the cuts, their leeways, and the largest leeway of each needle.
Whether the cuts are allowed it finds itself.

usage: certificate.py PLAN.tsv PLAN.json CANDIDATES.tsv; prints what is wrong and exits with 1, or "confirmed"."""

import csv
import json
import sys

import numpy as np

TOUCH = 1e-9  # mm: a margin is exceeded by more, and a distance of entries may be less by that
NONE = -1  # nm of a pair that does not go together


class Refuted(Exception):
    pass


def read_table(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file, delimiter="\t"))


def nanometres(mm):
    return np.floor(1e6 * np.asarray(mm, float) + 0.5).astype(np.int64)


def nanometres_or_none(text):
    return None if text == "n/a" else int(nanometres(float(text)))


def segments_distance(p, u, q, v):
    """Distances (n, m) of segments p + s u (n, 3) from q + t v (m, 3), 0 <= s, t <= 1: of all places where the least may
    be, four ends and the inside, the least."""
    p, u, q, v = p[:, None], u[:, None], q[None], v[None]
    dot = lambda a, b: (a * b).sum(-1)
    w, uu, vv, uv = p - q, dot(u, u), dot(v, v), dot(u, v)
    wu, wv = dot(w, u), dot(w, v)
    zero = np.zeros(np.broadcast(uu, vv).shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        det = uu * vv - uv * uv
        tries = [((uv * wv - vv * wu) / det, (uu * wv - uv * wu) / det)]
        tries += [(zero + s, (wv + s * uv) / vv) for s in (0, 1)]
        tries += [((t * uv - wu) / uu, zero + t) for t in (0, 1)]
    least = np.full(zero.shape, np.inf)
    for s, t in tries:
        s, t = (np.clip(np.nan_to_num(x, nan=0.0, posinf=0.0, neginf=0.0), 0, 1)[..., None] for x in (s, t))
        least = np.minimum(least, np.linalg.norm(w + s * u - t * v, axis=-1))
    return np.where(least <= TOUCH, 0, least)


class Needle:
    """The candidates of a needle, with where their bodies are."""

    def __init__(self, plan, index, rows):
        self.facts = plan["needles"][index]
        self.name = self.facts["name"]
        self.rows = [row for row in rows if row["needle"] == self.name]
        numbers = lambda *names: np.array([[float(row[name]) for name in names] for row in self.rows]).reshape(-1, len(names))
        self.question = np.array([int(row["row"]) - 1 for row in self.rows], int)
        self.number = np.array([int(row["candidate"]) for row in self.rows], np.int64)
        self.has_leeway = np.array([row["leeway_mm"] != "n/a" for row in self.rows], bool)
        self.leeway = nanometres([float(row["leeway_mm"]) if row["leeway_mm"] != "n/a" else 0 for row in self.rows])
        self.at, self.way, self.up = numbers("x", "y", "z"), numbers("dx", "dy", "dz"), numbers("ux", "uy", "uz")
        self.near, self.far = numbers("near"), numbers("far")
        self.contacts = np.array([int(row.get("contacts", 0)) for row in self.rows], np.int64)
        self.depth = nanometres(self.far[:, 0])
        self.tip = self.at + self.far * self.way
        right, anterior, dorsal = -self.way.T
        is_along = np.hypot(anterior, dorsal) <= np.radians(1e-9)
        self.arc = np.where(is_along, 0, np.degrees(np.arctan2(anterior, dorsal)))
        self.slider = np.degrees(np.arcsin(np.clip(right, -1, 1)))
        self.kin = None if self.facts["given"] else tuple(
            q for q, question in enumerate(plan["rows"]) if self.name in question["needles"])
        if len(set(self.number.tolist())) < len(self.number):
            raise Refuted(f"{self.name}: a candidate is there twice")
        if len(self.rows) != self.facts["candidates"]:
            raise Refuted(f"{self.name}: {len(self.rows)} of {self.facts['candidates']} candidates are there")

    def bodies(self, question):
        """(is a shaft, radius, ends (n, 3), ways (n, 3)) of each body of a question."""
        right = np.cross(self.up, -self.way)
        place = lambda x, y, h, base: base + x * right + y * self.up - h * self.way
        for x, y in question["shanks"]:
            ends = [place(x, y, -depth, self.at) for depth in (self.near, self.far)]
            yield True, question["radius_mm"], ends[0], ends[1] - ends[0]
        for part in question["parts"]:
            ends = [place(*point, self.tip if part["from"] == "tip" else self.at) for point in part["points"]]
            yield False, part["radius_mm"], ends[0], ends[1] - ends[0]


def turn(one, other):
    """Degrees (n, m) between angles, the short way round."""
    away = np.abs(np.asarray(one)[..., None] - other) % 360
    return np.minimum(away, 360 - away)


def fit_arcs(arcs, names, one, other):
    """(n, m): whether candidates are on one arc or on two, as their rows' names of arcs allow."""
    share = turn(one.arc, other.arc) <= arcs["same_deg"] + TOUCH
    is_named = None not in names
    may_share, may_not = not is_named or names[0] == names[1], not is_named or names[0] != names[1]
    return np.where(share, may_share & (turn(one.slider, other.slider) >= arcs["slider_deg"] - TOUCH),
                    may_not & (turn(one.arc, other.arc) >= arcs["spacing_deg"] - TOUCH))


def pair_leeways(plan, one, other):
    """(n, m) nm; NONE where two candidates do not go together."""
    leeways = np.full((len(one.number), len(other.number)), NONE, np.int64)
    for a, first in enumerate(plan["rows"]):
        for b, second in enumerate(plan["rows"]):
            block = np.ix_(one.question == a, other.question == b)
            if not leeways[block].size or (a == b and first["once"]):
                continue
            slack = np.full(leeways[block].shape, np.inf)
            for is_shaft, radius, end, way in one.bodies(first):
                for is_other, other_radius, other_end, other_way in other.bodies(second):
                    margin = plan["between"]["shafts_mm" if is_shaft and is_other else "parts_mm"]
                    distance = segments_distance(end[block[0][:, 0]], way[block[0][:, 0]],
                                                 other_end[block[1][0]], other_way[block[1][0]])
                    slack = np.minimum(slack, distance - radius - other_radius - margin)
            entries = np.linalg.norm(one.at[block[0][:, 0], None] - other.at[block[1][0]], axis=-1)
            goes = (slack > TOUCH) & (entries >= plan["entry_distance_mm"] - TOUCH)
            if plan["arcs"]:
                goes &= fit_arcs(plan["arcs"], (first["arc"], second["arc"]), one, other)[block]
            leeways[block] = np.where(goes, nanometres(slack / 2), NONE)
    if one.kin is not None and one.kin == other.kin:
        leeways[one.number[:, None] >= other.number] = NONE
    return leeways


class Answer:
    def __init__(self, plan, rows, candidates):
        self.plan = plan
        self.needles = [Needle(plan, i, candidates) for i in range(len(plan["needles"]))]
        count = len(self.needles)
        self.pairs = {(i, k): pair_leeways(plan, self.needles[i], self.needles[k])
                      for i in range(count) for k in range(i + 1, count)}
        for (i, k), leeways in list(self.pairs.items()):
            self.pairs[k, i] = leeways.T
        covers = plan.get("cover", [])
        self.contacts = sum(cover["contacts"] or 0 for cover in covers)
        if self.contacts and len(covers) > 1:
            raise Refuted("it covers several structures, of which the candidates do not say how many contacts are in each")
        numbers = [str(n + 1) for n in range(len(plan["combinations"]))]
        if [row["combination"] for row in rows] != [number for number in numbers for _ in self.needles]:
            raise Refuted("its rows are not one for each needle of each combination")
        self.listed = [self.find(rows[n * count:(n + 1) * count], n) for n in range(len(numbers))]

    def find(self, rows, n):
        """The candidates that the rows of a combination are."""
        chosen = []
        for needle, row in zip(self.needles, rows, strict=True):
            at = np.array([float(row[name]) for name in ("x", "y", "z", "tip_x", "tip_y", "tip_z")])
            away = np.abs(np.hstack([needle.at, needle.tip]) - at).max(1, initial=0) if len(needle.rows) else []
            found = [c for c, entry in enumerate(needle.rows) if away[c] < 1e-5 and entry["row"] == row["row"] and
                     row["query"] in (entry["query_id"], needle.name)]
            if row["needle"] != needle.name or len(found) != 1:
                raise Refuted(f"combination {n + 1}: {row['needle']}: {len(found)} candidates are its place")
            own = nanometres_or_none(row["leeway_mm"])
            if needle.has_leeway[found[0]] and (own is None or abs(own - needle.leeway[found[0]]) > 1):
                raise Refuted(f"combination {n + 1}: {row['needle']}: another leeway in its row than of its candidate")
            chosen.append(found[0])
        key = self.key(chosen)
        if key is None:
            raise Refuted(f"combination {n + 1}: two needles do not go together")
        has_leeway = len(chosen) > 1 or self.needles[0].has_leeway[chosen[0]]
        for row in rows:
            said = nanometres_or_none(row["all_leeway_mm"])
            if (said is None) == has_leeway or abs((said or 0) - key[0]) > 2:
                raise Refuted(f"combination {n + 1}: its leeway is {key[0] / 1e6} mm, not {row['all_leeway_mm']}")
            for name, value in (("all_sum_mm", key[1]), ("all_depth_mm", -key[2])):
                if nanometres_or_none(row[name]) != value:
                    raise Refuted(f"combination {n + 1}: {name} is {value / 1e6} mm, not {row[name]}")
            if (row["proven"], row["feasible"]) != ("1", "1"):
                raise Refuted(f"combination {n + 1}: {row['needle']}: it is not said to be proven and feasible")
        return chosen, key

    def keeps_arcs(self, chosen):
        """Whether candidates {needle: candidate}, each two of which fit, are on so few arcs, so few on each."""
        limits, arcs = self.plan["arcs"], []
        for i, c in chosen.items() if limits else ():
            angle = self.needles[i].arc[c]
            mine = [arc for arc in arcs if turn(angle, arc[0]) <= limits["same_deg"] + TOUCH]
            if not mine:
                arcs.append([])
            (mine or arcs[-1:])[0].append(angle)
        return not limits or (len(arcs) <= (limits["most"] or len(arcs)) and
                              all(len(arc) <= (limits["each"] or len(arc)) for arc in arcs))

    def key(self, chosen):
        """Leeway, sum, -depth, -numbers: larger is better; None where needles do not go together."""
        least = [int(n.leeway[c]) for n, c in zip(self.needles, chosen) if n.has_leeway[c]]
        for (i, k), leeways in self.pairs.items():
            least.append(int(leeways[chosen[i], chosen[k]]))
        contacts = sum(int(n.contacts[c]) for n, c in zip(self.needles, chosen))
        if (least and min(least) == NONE) or contacts < self.contacts or not self.keeps_arcs(dict(enumerate(chosen))):
            return None
        sums = [sum(int(values) for values in each) for each in (
            (n.leeway[c] for n, c in zip(self.needles, chosen)), (-n.depth[c] for n, c in zip(self.needles, chosen)))]
        return (min(least, default=0), *sums, *(-int(n.number[c]) for n, c in zip(self.needles, chosen)))

    def differs(self, chosen, before):
        """Whether a combination differs enough from one that is listed."""
        apart = (self.plan["diverse"] or {"apart_mm": 0, "needles": 1})
        count = 0
        for i, needle in enumerate(self.needles):
            near = False
            for k, other in enumerate(self.needles):
                if k == i or (needle.kin is not None and other.kin == needle.kin):
                    a, b = chosen[i], before[k]
                    is_same = needle.question[a] == other.question[b] and needle.number[a] == other.number[b]
                    ways = [np.linalg.norm(needle.at[a] - other.at[b]), np.linalg.norm(needle.tip[a] - other.tip[b])]
                    near = near or is_same or max(ways) < apart["apart_mm"] - TOUCH
            count += not near
        return count >= apart["needles"]

    def check_cuts(self):
        """Not above what the last combination allows (Eq. 28); nothing is left out that can be missed."""
        _, (least, total, *_) = self.listed[-1]
        is_last = self.plan["combinations"][-1]["last"]
        largest = [needle.facts["largest_leeway_mm"] for needle in self.needles]
        known = [0 if value is None else int(nanometres(value)) for value in largest]
        is_largest = least >= min((k for k, needle in zip(known, self.needles) if needle.has_leeway.all()), default=least)
        for needle, own, value in zip(self.needles, known, largest):
            cut = None if needle.facts["cut_mm"] is None else int(nanometres(needle.facts["cut_mm"]))
            if (value is None or cut is None) and needle.has_leeway.any():
                raise Refuted(f"{needle.name}: its candidates have leeways, and its largest one or its cut is not said")
            if needle.facts["given"]:
                continue
            allowed = max(least, total - (sum(known) - own))
            allowed = 0 if is_last else allowed if is_largest else min(allowed, least + 1)
            if cut is not None and cut > allowed + 1:
                raise Refuted(f"{needle.name}: its cut is {cut / 1e6} mm, and {allowed / 1e6} is allowed")
            most = needle.leeway[needle.has_leeway].max(initial=NONE)
            if most > own or most < own and cut is not None and own >= cut:
                raise Refuted(f"{needle.name}: {own / 1e6} mm is not the largest leeway of its candidates")
            for q, question in enumerate(self.plan["rows"]):
                mine = needle.question == q
                is_whole = cut is None or cut <= 0 or (mine & ~needle.has_leeway).any()
                if needle.name in question["needles"] and is_whole and mine.sum() != question["feasible"]:
                    raise Refuted(f"{needle.name}: {mine.sum()} of {question['feasible']} candidates of row {q + 1}")

    def search(self, n):
        """A combination that may stand there and is better than that which does; None: there is none."""
        least, total = self.listed[n][1][:2]
        return self.search_from(n, least + 1, -1) or self.search_from(n, least, total)

    def search_from(self, n, least, total):
        """Likewise, of those with so much leeway and such a sum."""
        best = self.listed[n][1] if n < len(self.listed) else (NONE,)
        order = sorted(range(len(self.needles)), key=lambda i: len(self.needles[i].number))

        def visit(chosen, domains):
            """Places the next needle at each candidate that goes with those before it."""
            most = sum(int(self.needles[i].leeway[c]) for i, c in chosen.items())
            contacts = sum(int(self.needles[i].contacts[c]) for i, c in chosen.items())
            for i in order[len(chosen):]:
                contacts += int(self.needles[i].contacts[domains[i]].max(initial=0))
                most += int(self.needles[i].leeway[domains[i]].max()) if domains[i].any() else -(10**18)
            if most < total or most < 0 or contacts < self.contacts or not self.keeps_arcs(chosen):
                return None
            if len(chosen) == len(order):
                whole = [chosen[i] for i in range(len(order))]
                is_better = self.key(whole) > best
                return whole if is_better and all(self.differs(whole, other) for other, _ in self.listed[:n]) else None
            i = order[len(chosen)]
            for c in np.flatnonzero(domains[i]):
                rest = {k: domains[k] & (self.pairs[i, k][c] >= max(least, 0)) for k in order[len(chosen) + 1:]}
                found = visit({**chosen, i: int(c)}, {**domains, **rest})
                if found:
                    return found
            return None

        return visit({}, {
            i: ~needle.has_leeway | (needle.leeway >= least) for i, needle in enumerate(self.needles)})


def confirm(plan_path, sidecar_path, candidates_path):
    with open(sidecar_path, encoding="utf-8") as file:
        sidecar = json.load(file)
    plan = sidecar["Plan"]
    if plan["arcs"] and sidecar.get("Space", {"orientation": "RAS"})["orientation"] != "RAS":
        raise Refuted("arcs are judged in RAS alone")
    answer = Answer(plan, read_table(plan_path), read_table(candidates_path))
    if not answer.listed or not all(entry["proven"] for entry in plan["combinations"]):
        raise Refuted("it is no answer that is proven")
    answer.check_cuts()
    for n, (chosen, _) in enumerate(answer.listed):
        if not all(answer.differs(chosen, other) for other, _ in answer.listed[:n]):
            raise Refuted(f"combination {n + 1}: it is too much like one before it")
        better = answer.search(n)
        if better:
            raise Refuted(f"combination {n + 1}: {[int(needle.number[c]) for needle, c in zip(answer.needles, better)]} "
                          f"is better: {answer.key(better)[:3]} nm, not {answer.listed[n][1][:3]}")
    if plan["combinations"][-1]["last"] and answer.search_from(len(answer.listed), 0, NONE):
        raise Refuted("there is another combination behind the last one")
    return len(answer.listed)


def main(paths):
    try:
        print(f"confirmed: {confirm(*paths)} combinations")
    except Refuted as why:
        print(f"refuted: {why}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
