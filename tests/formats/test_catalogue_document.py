"""docs/catalogue.md is up to date, and every drive gives its data sheet back."""

import pytest

from catalogue_document import DOCUMENT, Check, checks, document, half_unit, torsions
from cutpoint.formats import catalogue_names
from cutpoint.studies.drive.measured import Specimen

FITTED = 0.025
"""What efficiencies of CSD gears at ratio 100 depart from their six points by; measured: 0.0244."""


@pytest.fixture(scope="module")
def found() -> list[tuple[Specimen, Check]]:
    specimens = [Specimen(name) for name in catalogue_names()]
    return [(specimen, check) for specimen in specimens for check in checks(specimen)]


def of(found: list[tuple[Specimen, Check]], quantity: str) -> list[tuple[Specimen, Check]]:
    chosen = [(specimen, check) for specimen, check in found if check.quantity.startswith(quantity)]
    assert chosen
    return chosen


def test_the_document_is_up_to_date() -> None:
    assert DOCUMENT.read_text(encoding="utf-8") == document(), "run: python tests/catalogue_document.py"


def test_every_drive_with_a_stiffness_an_angle_or_a_point_is_checked(found: list[tuple[Specimen, Check]]) -> None:
    checked = {specimen.gear.name for specimen, _ in found}
    assert checked == set(catalogue_names())


@pytest.mark.parametrize(
    ("number", "half"),
    [(2.0, 0.05), (6.9, 0.05), (14.0, 0.5), (108.0, 0.5), (4700.0, 50.0), (110e3, 5e3), (1e4, 500.0)],
)
def test_a_printed_number_stands_for_half_a_unit_of_its_last_digit(number: float, half: float) -> None:
    assert half_unit(number) == pytest.approx(half, rel=1e-12)


@pytest.mark.parametrize("name", [name for name in catalogue_names() if Specimen(name).spring])
def test_torsion_at_both_corners_is_within_the_rounding_of_the_sheet(name: str) -> None:
    specimen = Specimen(name)
    spring = specimen.spring
    assert spring is not None
    stated = [float(x) for x in (spring.k1, spring.k2, spring.t1, spring.t2)]
    first, second = torsions(*stated)
    at_t1, at_t2 = (float(spring.deflection(t)) for t in stated[2:])
    assert first[0] < at_t1 < first[1]
    assert second[0] < at_t2 - at_t1 < second[1]


def test_rounded_corners_move_a_chord_by_less_than_a_fortieth(found: list[tuple[Specimen, Check]]) -> None:
    """A corner lifts torque by 3/32 of the change of stiffness times its width, at most half of the first torsion."""
    for specimen, check in of(found, "stiffness"):
        spring = specimen.spring
        assert spring is not None
        assert abs(check.departure) < 1 / 40
        change = max(abs(spring.k2 - spring.k1), abs(spring.k3 - spring.k2))
        assert spring.fit_error <= 3 / 64 * change * spring.t1 / spring.k1 * (1 + 1e-12)


@pytest.mark.parametrize("quantity", ["hysteresis loss", "transmission accuracy"])
def test_angles_are_the_sheets(found: list[tuple[Specimen, Check]], quantity: str) -> None:
    for _, check in of(found, quantity):
        assert abs(check.departure) < 1e-6


def test_no_load_torque_is_the_sheets(found: list[tuple[Specimen, Check]]) -> None:
    for _, check in of(found, "no-load torque"):
        assert abs(check.departure) < 1e-9


def test_efficiency_is_the_sheets_where_it_has_one_point_and_near_where_all_is_fitted(
    found: list[tuple[Specimen, Check]],
) -> None:
    for specimen, check in of(found, "efficiency"):
        assert abs(check.departure) < (FITTED if specimen.is_fitted else 1e-6)


def test_lost_motion_keeps_the_sheets_bound() -> None:
    """Of gears; an actuator's spring bends too."""
    for name in catalogue_names():
        specimen = Specimen(name)
        sheet, motion = specimen.gear.hysteresis, specimen.lost_motion
        if sheet and sheet.lost_motion_arcmin and motion is not None and not specimen.gear.output:
            assert 0.0 < motion < sheet.lost_motion_arcmin * 2.908882086657216e-4
