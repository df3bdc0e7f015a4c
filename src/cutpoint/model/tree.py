"""From links and joints in any order to one tree, walked depth first."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence

from cutpoint.errors import ModelError, listed, those_that_exist
from cutpoint.model.mechanism import Joint, Link
from cutpoint.model.places import Places


def depth_first(links: Sequence[Link], joints: Sequence[Joint], places: Places) -> tuple[str, list[Joint]]:
    """The root link's name, and the joints parents first; children keep the order in which the joints are listed.

    Raises ModelError: no links, a name twice, an unknown link, a link with two parents, a loop, not exactly one root.
    """
    if not links:
        remedy = "if the file only defines macros, give the one that calls them"
        raise ModelError(f"the robot has no links; {remedy}", place=places.of(""))
    _check_unique("link", [link.name for link in links], places)
    _check_unique("joint", [joint.name for joint in joints], places)
    carrier = _carriers([link.name for link in links], joints, places)
    root = _only_root([link.name for link in links], carrier, places)
    ordered = _walk(root, joints)
    if len(ordered) < len(joints):
        raise _loop_error(carrier, {joint.child for joint in joints} - {joint.child for joint in ordered}, places)
    return root, ordered


def _check_unique(kind: str, names: Iterable[str], places: Places) -> None:
    for name, count in Counter(names).items():
        if not name:
            raise places.error(kind, "a name must not be empty")
        if count > 1:
            raise places.error(f"{kind} {name!r}", f"is defined {count} times; names must be unique", name=name)


def _carriers(links: Sequence[str], joints: Sequence[Joint], places: Places) -> dict[str, Joint]:
    """The joint that carries each link."""
    known, carrier = set(links), {}
    for joint in joints:
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in known:
                remedy = "; add a link of that name, without mass" if link == "world" else ""
                complaint = f"{role} link {link!r} does not exist; {those_that_exist(link, links)}{remedy}"
                raise places.error(f"joint {joint.name!r}", complaint, joint=joint.name, link=link)
        if joint.child in carrier:
            both = f"{carrier[joint.child].name!r} and {joint.name!r}"
            complaint = f"is the child of two joints, {both}; a link has one parent (closed loops are not supported)"
            raise places.error(f"link {joint.child!r}", complaint, link=joint.child)
        carrier[joint.child] = joint
    return carrier


def _only_root(links: Sequence[str], carrier: dict[str, Joint], places: Places) -> str:
    roots = [link for link in links if link not in carrier]
    if not roots:
        raise _loop_error(carrier, set(links), places)
    if len(roots) > 1:
        complaint = f"links {listed(roots)} have no parent joint; exactly one link, the root, may have none"
        raise ModelError(complaint, place=places.of(f"link {roots[1]!r}"), roots=roots)
    return roots[0]


def _walk(root: str, joints: Sequence[Joint]) -> list[Joint]:
    """Joints reached from the root, depth first, with an explicit stack, since chains may be of any length."""
    borne = defaultdict(list)
    for joint in joints:
        borne[joint.parent].append(joint)
    ordered, stack = [], borne[root][::-1]
    while stack:
        joint = stack.pop()
        ordered.append(joint)
        stack.extend(borne[joint.child][::-1])
    return ordered


def _loop_error(carrier: dict[str, Joint], suspects: set[str], places: Places) -> ModelError:
    """Error that names the loop: every suspect's parent is a suspect, so going up from any of them ends in one."""
    link, climbed = min(suspects), {}
    while link not in climbed:
        climbed[link] = len(climbed)
        link = carrier[link].parent
    upward = list(climbed)[climbed[link] :]
    loop = [link, *upward[:0:-1], link]
    joint = carrier[link]
    complaint = f"closes a loop of links, {listed(loop, ' -> ')}; the links of a robot must form a tree"
    return places.error(f"joint {joint.name!r}", complaint, joint=joint.name, loop=loop)
