"""Words of marker sets for positions on a body: anatomical Latin, English, French, initials, joint centres."""

import re
from collections.abc import Sequence
from functools import lru_cache

from studio.core.markers.roles import SIDE_WORDS

_OUTER, _INNER = r"(l|la?t|lateral|out|outer|ext)", r"(m|me?d|medial|in|inner|int)"
_CENTRE_WORD = r"(jc|(joint)?.?cent(er|re)|jnt|joint)"
_SEGMENT_WORD = r".?4x4"
"""Ends the pose of a segment, which begins at its upper joint."""

PART_WORDS: tuple[tuple[str, str], ...] = (
    (
        "back_hip",
        r"psi?s?|bwt|ips|eips|eps|(waist|hip|pelvis).?back|back.?(waist|hip|pelvis)|post(erior)?.?(sup(erior)?.?)?iliac.*",
    ),
    (
        "front_hip",
        r"asi?s?|fwt|ias|eias|eas|(waist|hip|pelvis).?front|front.?(waist|hip|pelvis)|ant(erior)?.?(sup(erior)?.?)?iliac.*",
    ),
    ("sacrum", r"v?\.?sacr?(um|al)?|s1"),
    ("pelvis", r"pv\d*|pelv(is)?\d*|waist\d*"),
    ("hip centre", rf"hjc|hip.?{_CENTRE_WORD}|thigh{_SEGMENT_WORD}"),
    ("knee centre", rf"kjc|knee.?{_CENTRE_WORD}|shank{_SEGMENT_WORD}"),
    ("ankle centre", rf"ajc|ankle.?{_CENTRE_WORD}|foot{_SEGMENT_WORD}"),
    ("shoulder centre", rf"sjc|gh.?{_CENTRE_WORD}|shoulder.?{_CENTRE_WORD}|u(pper)?_?arm{_SEGMENT_WORD}"),
    ("elbow centre", rf"ejc|elbow.?{_CENTRE_WORD}|l(ower)?_?arm{_SEGMENT_WORD}"),
    ("wrist centre", rf"wjc|wrist.?{_CENTRE_WORD}|hand{_SEGMENT_WORD}"),
    (
        "inner_knee",
        rf"fme|mfe|mek|cm|mfc|knm|kne.?m|mknee?|(knee?|k|fe|genou).?{_INNER}|{_INNER}.?(knee?|fem.*|cond.*)|knee.?med.?epi.*",
    ),
    (
        "knee",
        rf"knee?|fle|lfe|lek|lke|cl|lfc|lk|genou|(knee?|k|fe|genou).?{_OUTER}|{_OUTER}.?(knee?|fem.*|cond.*)|"
        r"knee.?lat.?epi.*",
    ),
    (
        "inner_ankle",
        rf"tam|mank(le)?|mma?l?|med|(ankl?e?|an|a|mal|cheville).?{_INNER}|{_INNER}.?(ank(le?)?|mal(l(eolus)?)?)",
    ),
    (
        "ankle",
        rf"ankl?e?|fal|lma?l?|ml|mall?(eolus)?|cheville|(ankl?e?|an|a|mal|cheville).?{_OUTER}|"
        rf"{_OUTER}.?(ank(le?)?|mal(l(eolus)?)?)",
    ),
    ("heel", r"hee?l?|hl|[pd]he|heel.?(back|foot|prox\w*|top|cent(er|re))|cal(c(aneus|aneum)?)?|fcc|ca|h|talon"),
    (
        "inner_toe",
        rf"f?mth?1|fm1|mh1|mtp1|[1i](st)?.?(met(atarsal)?|mt|mh|mtp)|1st|fmh|d1m|fm|(toe|forefoot|foot|ft).?{_INNER}|"
        r"first.?met.*|meta(tars\w*)?.?1",
    ),
    (
        "outer_toe",
        rf"f?mth?5|fm5|mh5|mtp5|5(th)?.?(meta?|metatarsal|mt|mh|mtp)|5th|vmh?|d5m|fl|(toe|forefoot|foot|ft).?{_OUTER}|"
        r"fifth.?met.*|meta(tars\w*)?.?5",
    ),
    ("met", r"met\d*|mt"),
    ("big_toe", r"(big|great|1st|first).?toe\d?|(toe|foot).?(tip|end|nail)|hal(lux)?|hlx|dp1|gros.?orteil"),
    (
        "toe",
        rf"toe|toe.?base|tjc|toe.?{_CENTRE_WORD}|metatarsal.?[23]|foot.?index|to|toes|f?mth?[23]|fm[23]|mh[23]|[23](nd|rd)?.?(met(atarsal)?|mt|mh|mtp)|2nd|smh?|"
        r"foo\d*|fore.?foot|ball|second.?met.*|orteil",
    ),
    ("foot", r"ft\d*|foot\d*"),
    ("thigh", r"bar.?1|thi(gh)?\d*|th\d*|femur\d*|uleg\d*|tha[pd]|thia[pd]"),
    ("shank", r"bar.?2|sha(nk)?\d*|shi?n\d*|ti?b(ia)?\d*|ttc|fax|sk\d*|lleg\d*|tia[pd]|tiba[pd]"),
    ("hip", rf"hip|hip.?{_OUTER}|gt(ro?)?|ftc|troc(h(anter)?)?|greater.?troch.*|gr.?troch.*|tro|hanche"),
    ("shoulder", r"sho(ulder)?|sh(ou)?ldr|should|[cs]aj|sa[ae]|acr(omi\w*)?|ac|acrom|shoulder.?top|sho.?top|[eé]paule"),
    (
        "inner_elbow",
        rf"(elb(ow)?|coude).?{_INNER}|hme|mhe|mee|mel|elm|em|el.?m|melb(ow)?|{_INNER}.?(elb(ow)?|hum.*epi.*)",
    ),
    (
        "elbow",
        rf"elb(ow)?|hle|lhe|lee|lel|ell|el|cou(de)?|(elb(ow)?|coude).?{_OUTER}|lelb(ow)?|{_OUTER}.?(elb(ow)?|hum.*epi.*)|ael",
    ),
    (
        "wrist",
        r"wra|wts|wri(st?)?.?(a|thumb|rad(ius|ial)?|m|in|inner|int|la?t|lateral)|rsp?|rhe|(fa.?)?rad(ius|ial)?(.?sty(loid)?)?|"
        r"sty(l(oid)?)?.?rad.*|"
        r"(l|la?t|lateral).?w(rist)?|wrr?|wm|poignet.?(ext\w*|rad\w*)",
    ),
    (
        "outer_wrist",
        r"wrb|wps|wri(st?)?.?(b|pinky|little|uln(ar?)?|l|out|outer|ext|me?d|medial)|usp?|uhe|(fa.?)?uln(ar?)?(.?sty(loid)?)?|"
        r"sty(l(oid)?)?.?uln.*|"
        r"(m|me?d|medial).?w(rist)?|wr?u|wl|poignet.?(int\w*|uln\w*|cub\w*)",
    ),
    ("wrists", r"wri(st)?\d*|mai|poignet"),
    ("hand", r"fin(ger)?|hmc?[235]|mc[235]|hand\d*|knu(ckle)?|hand.?(in|out)|main\d*|doigt\d*"),
    ("upper_arm", r"upa|uarm\d*|upper.?arm\d*|arm\d*|uarm.?high"),
    ("forearm", r"fra|frm|farm\d*|fore.?arm\d*"),
    ("front_head", r"fhd|hdf|front.?head|head.?front|t[eê]te?|temp(le)?|t[eê]te.?(av|ant|devant)\w*"),
    ("back_head", r"bhd|hdb|back.?head|head.?back|t[eê]te.?(ar|post|derr)\w*"),
)
"""Regular expressions for the parts of a side; the first one that matches a label without its side is taken."""
MIDDLE_WORDS: tuple[tuple[str, str], ...] = (
    ("neck_back", r"c(v|ervical)?.?7|spine.?top|neck|back.?top"),
    ("back", r"t(v?h?|horacic).?(8|9|10|12)|spine.?(mid|thoracic\d*)"),
    (
        "collar",
        r"clav(icle)?|ij|sjn|cl|(jug(ular)?|supra.?sternal)?.?notch|ssn|manub?(rium)?|jug(ular)?|collar|ster|incis.*",
    ),
    ("breastbone", r"strn|stern(um)?|px|sxs|x[iy]ph?(oid)?(.?proc\w*)?|chest|xpro|xyph"),
    ("sacrum", r"v?\.?sacr?(um|al)?|s1"),
)
"""Regular expressions for labels in the middle of the body, which name no side."""
INITIALS: tuple[tuple[str, str], ...] = (
    ("knee", rf"le|lep|kn?|{_OUTER}.?epi.*"),
    ("inner_knee", rf"me|mep|{_INNER}.?epi.*"),
    ("ankle", r"an?"),
    ("elbow", rf"e|le|lep|{_OUTER}.?epi.*"),
    ("inner_elbow", rf"me|mep|{_INNER}.?epi.*"),
    ("shoulder", r"a|sh?"),
    ("outer_wrist", r"u"),
    ("wrist", r"r|w"),
    ("toe", r"t|f"),
    ("inner_toe", r"(toe|t|m).?1"),
    ("outer_toe", r"(toe|t|m).?5"),
)
"""Regular expressions for letters that marker sets use differently: each stands for the first of its parts that no
other label names.
"""
_FRENCH = (("left", "gauche"), ("right", "droite"), ("right", "droit"), ("left", "g"), ("right", "d"))
_SHORTEST_FRENCH = 4
"""Letters of a word beside which G and D name a side."""
_FEWEST_FRENCH = 8
"""Labels of a set with a counterpart on the other side, G for D, where a letter alone names the side."""
_NUMBERED = re.compile(r"[_ ]\d+$")
_TOKENS = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+")


@lru_cache(maxsize=4096)
def side_and_part(label: str) -> tuple[str, str] | None:
    """(side, part) named by a label; the side is empty in the middle of the body. None for an unknown label."""
    said = _said(label) or _said(_NUMBERED.sub("", label))
    return said or (None if initials_of(label)[1] else _said(label.rstrip("0123456789")))


def with_english_sides(labels: Sequence[str]) -> dict[str, str]:
    """Labels by the original label, with L and R for G and D (*gauche*, *droite*) if these name the sides of a set."""
    there = set(labels)
    counts = [sum({left + label[1:], right + label[1:]} <= there for label in labels) for left, right in ("GD", "LR")]
    if counts[0] < _FEWEST_FRENCH or counts[0] <= counts[1]:
        return {label: label for label in labels}
    return {label: {"G": "L", "D": "R"}.get(label[:1], label[:1]) + label[1:] for label in labels}


def initials_of(label: str) -> tuple[str, list[str]]:
    """Side of a label, and the parts that its letters may stand for, the likeliest first."""
    for side, rest in _sides_at_the_ends(label.lower()):
        if parts := [part for part, words in INITIALS if re.fullmatch(words, rest)]:
            return side, parts
    return "", []


def _said(label: str) -> tuple[str, str] | None:
    plain = label.lower()
    for part, words in MIDDLE_WORDS:
        if re.fullmatch(words, plain):
            return "", part
    for side, rest in (*_sides_at_the_ends(plain), *_side_within(label)):
        said = _part(rest)
        if said is not None:
            return side, said
    return ("", "pelvis") if _part(plain) == "pelvis" else None


def _sides_at_the_ends(plain: str) -> list[tuple[str, str]]:
    """Side at the beginning or end of a label, and the rest: ``lknee``, ``knee_l``, ``left.knee``."""
    names = [(side, name) for side in SIDE_WORDS for name in (side, side[0])]
    names += [(side, f"{side[0]}t") for side in SIDE_WORDS]
    found = [(side, plain[len(name) :]) for side, name in names if plain.startswith(name)]
    found += [(side, plain[: -len(name)]) for side, name in names if plain.endswith(name)]
    stripped = [(side, rest.strip(" ._-")) for side, rest in found]
    french = [(side, plain[len(name) :].strip(" ._-")) for side, name in _FRENCH if plain.startswith(name)]
    french += [(side, plain[: -len(name)].strip(" ._-")) for side, name in _FRENCH if plain.endswith(name)]
    return stripped + [(side, rest) for side, rest in french if len(rest) >= _SHORTEST_FRENCH]


def _side_within(label: str) -> list[tuple[str, str]]:
    """Side among joined words: ``WaistLFront``, ``pLeftToe``."""
    tokens = [token.lower() for token in _TOKENS.findall(label)]
    tokens = tokens[tokens[:1] == ["p"] :]  # Xsens writes p before a point
    at = [index for index, token in enumerate(tokens) if token in ("l", "r", *SIDE_WORDS)]
    if len(at) != 1:
        return []
    side = next(side for side in SIDE_WORDS if side.startswith(tokens[at[0]]))
    return [(side, "".join(tokens[: at[0]] + tokens[at[0] + 1 :]))]


def _part(word: str) -> str | None:
    return next((part for part, words in PART_WORDS if word and re.fullmatch(words, word)), None)
