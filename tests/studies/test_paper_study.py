"""The report of section IV: complete, self-contained, and true to its claims.  One run serves every test."""

import json
import struct
from html.parser import HTMLParser

import numpy as np
import pytest
from matplotlib.figure import Figure

from cutpoint.errors import InputError
from cutpoint.reporting.html import Heading, html
from cutpoint.reporting.page import Page, Picture, Table, number, plain
from cutpoint.studies.paper import run, study
from cutpoint.studies.paper.bench import Bench
from cutpoint.studies.paper.stability import fastest_growth

FIGURES = [*(f"figure_{k}" for k in range(1, 15)), *(f"figure_a{k}" for k in range(1, 7))]
TABLES = ["table_3", "table_4", "table_5", *(f"table_a{k}" for k in range(1, 8))]
ALL = "+ elasticity: all rungs"
RINGING = "encoders and delay together"


@pytest.fixture(scope="module")
def output(tmp_path_factory):
    folder = tmp_path_factory.mktemp("paper")
    run(folder, progress=False)
    return folder


@pytest.fixture(scope="module")
def results(output):
    return json.loads((output / "results.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def table_4(results):
    """RMS by row: positions in degrees and torques in N m, (6,) each."""
    rows = results["table_4"]["ours"]
    return {name: (np.array(row["position_rms"]), np.array(row["torque_rms"])) for name, row in rows.items()}


@pytest.fixture(scope="module")
def alone(results):
    """RMS by single imperfection of the stand-in: positions in degrees and torques in N m, (2,) each."""
    rows = results["table_a4"]["alone"]
    return {name: (np.array(row["position_rms"]), np.array(row["torque_rms"])) for name, row in rows.items()}


class Links(HTMLParser):
    """What a page refers to, and the ids it offers."""

    def __init__(self):
        super().__init__()
        self.sources, self.links, self.ids, self.tags = [], [], [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        for name, value in attrs:
            {"src": self.sources, "href": self.links, "id": self.ids}.get(name, []).append(value)


def parsed(text):
    links = Links()
    links.feed(text)
    return links


# the report


def test_every_figure_and_table_has_its_results(results):
    assert set(FIGURES) | set(TABLES) <= set(results)
    assert results["versions"]["numpy"] == np.__version__
    assert results["settings"]["kp"] == [2000, 2000, 1000, 500, 300, 200]


def test_all_numbers_are_finite(results):
    def leaves(x):
        if isinstance(x, dict | list):
            for y in x.values() if isinstance(x, dict) else x:
                yield from leaves(y)
        else:
            yield x

    numbers = [x for x in leaves(results) if isinstance(x, float | int)]
    assert len(numbers) > 300
    assert np.isfinite(numbers).all()
    assert None not in [*leaves(results)]


def test_every_figure_is_a_png_large_enough_to_read(output, results):
    for key in FIGURES:
        content = (output / results[key]["file"]).read_bytes()
        width, height = struct.unpack(">II", content[16:24])
        assert content.startswith(b"\x89PNG") and width >= 1400 and height >= 500


def test_the_report_needs_nothing_outside_itself(output):
    text = (output / "index.html").read_text(encoding="utf-8")
    found = parsed(text)
    assert len(found.sources) == len(FIGURES)
    assert all(source.startswith("data:image/png;base64,") for source in found.sources)
    assert found.links and all(link.startswith("#") and link[1:] in found.ids for link in found.links)
    assert not {"script", "link", "iframe", "object"} & set(found.tags)
    assert "url(" not in text and "@import" not in text


def test_the_report_shows_the_papers_numbers_beside_ours(output):
    text = (output / "index.html").read_text(encoding="utf-8")
    shaded = [line for line in text.splitlines() if 'class="printed"' in line]
    for cells in (["22.7", "8.9"], ["0.1336", "0.0080"], ["0.4594", "0.0513"], ["0.0456", "0.2981"]):
        assert any(all(f"<td>{cell}</td>" in line for cell in cells) for line in shaded)


def test_whatever_a_page_says_is_text_and_not_markup():
    nasty = '<script>alert("x")</script>'
    table = Table("Table 9", nasty, (nasty,), ((nasty,),))
    page = Page("key", nasty, (nasty, table, Picture("Figure 9", nasty, Figure())))
    found = parsed(html(Heading(nasty, nasty, (nasty,)), [page], {"figure_9": b""}, {nasty: nasty}))
    assert "script" not in found.tags


def test_marks_become_tags_in_the_report_and_subscripts_vanish_elsewhere():
    assert "K<sub>f0</sub> = 10<sup>−3</sup>" in html(Heading("", "", ()), [Page("k", "K_{f0} = 10^{−3}", ())], {}, {})
    assert "as <code>a &lt; b</code> has it" in html(Heading("", "as `a < b` has it", ()), [], {}, {})
    assert plain("K_{f0} = 2.5·10^{−3}") == "Kf0 = 2.5e−3"


def test_small_numbers_are_not_shown_as_zero():
    assert number(0.0, 2) == "0.00" and number(-1.25, 2) == "−1.25" and number(3.2e-7, 2) == "3.2·10^{−7}"


def test_an_interrupted_study_leaves_no_file(tmp_path, monkeypatch):
    def interrupted(bench):
        raise KeyboardInterrupt

    monkeypatch.setitem(study._PAGES, "Table 3: torques against Newton-Euler and Lagrange", interrupted)
    monkeypatch.setitem(study._PAGES, "drawing joint and arm", lambda bench: Page("empty", "", ()))
    with pytest.raises(KeyboardInterrupt):
        run(tmp_path, progress=False)
    assert not [*tmp_path.rglob("*")]


def test_an_output_that_is_a_file_is_refused(tmp_path):
    file = tmp_path / "report"
    file.write_text("mine")
    with pytest.raises(InputError, match="report' is not a folder"):
        run(file, progress=False)
    assert file.read_text() == "mine"


# what it claims


def test_virtual_decomposition_is_newton_euler_and_lagrange_to_rounding(results):
    scale = max(results["figure_7"]["peak"])
    for ours in ("ours", "ours_against_lagrange"):
        assert results["table_3"][ours]["largest"] / 1e3 < 1e-12 * scale


@pytest.mark.parametrize(
    ("named", "rms", "largest"),
    [
        ("torques 0.1 % off", [0.099, 22.58, 8.91, 0.635, 2.28, 0.0], 32.0),
        ("all lengths and centroids", [0.197, 22.65, 8.96, 0.637, 2.29, 0.0], 32.2),
        ("g = 9.81 in one", [0.0, 22.95, 9.02, 0.65, 2.31, 0.0], 32.5),
        ("the same g", [0.0, 19.94, 5.41, 0.65, 2.31, 0.0], 26.5),
    ],
)
def test_candidates_for_table_3_give_the_differences_found_elsewhere(results, named, rms, largest):
    """Figures of an independent computation, to its digits."""
    (found,) = [row for name, row in results["table_3"]["candidates"].items() if name.startswith(named)]
    np.testing.assert_allclose(found["rms"], rms, atol=0.008)
    np.testing.assert_allclose(found["largest"], largest, atol=0.05)


def test_only_with_the_hand_ahead_of_the_wrist_does_a_candidate_come_near_table_3(results):
    misses = {name: np.abs(np.subtract(row["rms"], results["table_3"]["paper"]["rms"])).max()
              for name, row in results["table_3"]["candidates"].items()}  # fmt: skip
    assert max(miss for name, miss in misses.items() if "as printed" not in name) < 0.3
    assert min(miss for name, miss in misses.items() if "as printed" in name) > 3


def test_all_rungs_are_better_than_pd_alone_on_every_joint(table_4):
    for without, together in zip(table_4["PD alone"], table_4[ALL], strict=True):
        assert (together < without).all()


def test_gravity_is_what_pd_alone_lacks_most_where_joints_bear_weight(table_4):
    loaded = [1, 2, 4]
    assert (table_4["+ gravity"][0][loaded] < 0.3 * table_4["PD alone"][0][loaded]).all()


def test_the_motor_reference_helps_the_joints_that_bear_weight(table_4):
    loaded = [1, 2, 4]
    assert (table_4[ALL][0][loaded] < 0.5 * table_4["+ friction"][0][loaded]).all()


def test_without_friction_all_rungs_leave_almost_nothing(table_4):
    position, torque = table_4["no friction: all rungs"]
    assert position.max() < 2e-4 and torque.max() < 5e-3


def test_damped_drives_end_the_vibration_that_friction_excites(table_4, results):
    damped = next(row for name, row in table_4.items() if "damped" in name)
    assert (damped[1] < 0.05 * table_4[ALL][1]).all()
    assert min(results["figure_11"]["vibration_hz"]) > 80


def test_link_side_pd_is_unstable_at_any_gain_and_motor_side_pd_at_none():
    bench = Bench()
    for scale in (1e-4, 1e-2, 1.0, 10.0):
        assert fastest_growth(bench, "link", scale) > 1e-6
        assert fastest_growth(bench, "motor", scale) < -1e-6


def test_link_side_pd_chatters_with_friction_and_swings_without_end_without(results):
    motor, *link = results["table_a1"]["loops"]
    assert max(motor["torque_peak"]) < 100
    assert max(link[0]["torque_peak"]) > 200 and max(link[0]["torque_rms"]) > 5 * max(motor["torque_rms"])
    assert all(loop["swing"] > 10 * motor["swing"] for loop in link if not loop["friction"])


def test_the_shipped_drives_keep_to_their_catalogue(results):
    sizes = results["table_a2"]["sizes"]
    shipped = [sizes[f"size {n}"]["shipped"]["departure"] for n in (20, 17, 14)]
    np.testing.assert_allclose(shipped, [0.22, 0.12, 0.15], atol=0.01)
    fitted = [sizes[f"size {n}"]["fitted"] for n in (20, 17, 14)]
    np.testing.assert_allclose([fit["stiffness"] for fit in fitted], [17060, 10310, 4928], rtol=2e-3)
    np.testing.assert_allclose([fit["hardening"] for fit in fitted], [0.0432, 0.0761, 0.108], rtol=1e-2)


def test_torque_is_read_exactly_by_ideal_encoders_and_better_by_finer_ones(results):
    ideal, fine, coarse, stiffer = (np.array(x) for x in results["table_a3"]["error_rms"].values())
    assert ideal.max() < 1e-9
    assert (fine < 0.5 * coarse).all()
    assert (stiffer > 0.15 * np.array(results["table_a3"]["true_rms"])).all()


def test_gear_friction_is_what_costs_most_unless_the_feedforward_knows_it(results):
    added = results["table_a5"]["added"]
    shares = {effect: found["share"]["not_known"] for effect, found in added.items()}
    assert max(shares, key=shares.get) == "gear friction"
    assert all(found["recovered"] > 0.8 for effect, found in added.items() if effect != "current loop and delay")
    assert abs(added["current loop and delay"]["recovered"]) < 0.01


@pytest.mark.parametrize("key", ["table_5", "table_a4", "figure_12", "figure_13", "figure_14"])
def test_what_stands_in_for_the_experiment_is_named_so(results, key):
    assert results[key]["simulated_stand_in"] is True
    assert results[key]["caption"].startswith("Simulated stand-in for the experiment")


def test_the_stand_in_has_twenty_seeds_and_their_spread(results):
    table = results["table_5"]
    assert table["settings"]["seeds"] == [*range(20)]
    assert table["settings"]["imperfections"].keys() == table["settings"]["imperfection_units"].keys()
    for name, values in table["by_seed"].items():
        assert np.shape(values) == (20, 2)
        np.testing.assert_array_equal(table["median"][name], np.median(values, axis=0))
        assert (np.array(table["lowest"][name]) < table["median"][name]).all()
        assert (np.array(table["highest"][name]) > table["median"][name]).all()


def test_the_stand_in_moves_as_the_experiment_did(results):
    np.testing.assert_allclose(results["figure_12"]["poses"], [[0, 0], [30, 15], [60, 30]], atol=0.1)
    np.testing.assert_allclose(results["figure_12"]["time"], [0, 15, 30], atol=1e-9)


def test_no_seed_of_the_stand_in_rings_or_leaves_the_printed_bound(results):
    highest = results["table_5"]["highest"]
    assert max(highest["torque_rms"]) < 2.0
    assert max(highest["position_peak"]) < results["table_5"]["paper"]["position_peak_at_most"]


def test_without_imperfections_the_stand_in_leaves_almost_nothing(alone):
    position, torque = alone["none: the plant is the model"]
    assert position.max() < 1e-4 and torque.max() < 1e-3


def test_what_the_stand_in_says_of_single_imperfections_holds(alone):
    left, _ = alone["none: the plant is the model"]
    for idle in ("rotor inertia", "drive damping"):
        np.testing.assert_allclose(alone[idle][0], left, rtol=0.2)
    for hidden in ("stiffness", "friction: on which side"):
        assert (alone[hidden][0] > 10 * left).all() and alone[hidden][1].max() < 0.01
    assert alone["delay"][1].max() < 0.01
    for rough in ("torque ripple", "encoders"):
        assert alone[rough][1][0] > 0.1173


def test_kinematic_error_costs_most_where_the_drive_bears_weight(alone):
    light, loaded = alone["kinematic error"][1]
    assert loaded > 5 * light
    assert loaded > 2 * 0.2981
    assert loaded == max(torque[1] for name, (_, torque) in alone.items() if name != RINGING)


def test_differenced_speeds_and_delay_together_ring_where_each_alone_does_not(alone):
    assert alone[RINGING][1][1] > 50.0
    assert max(alone["encoders"][1][1], alone["delay"][1][1]) < 0.5
