"""The client against a running service (MESHWRIGHT_URL)."""

from __future__ import annotations

import asyncio
import os
import urllib.request

import httpx
import meshio
import numpy as np
import pytest

from meshwright import AsyncClient, Client, ProblemError


@pytest.fixture()
def service():
    with Client() as client:
        yield client


def test_case_2_has_the_mean_of_the_paper(service):
    told = []
    results = service.solve(service.example("test-case-2"), progress=lambda done, total: told.append((done, total)))
    curve = results.curves[0]
    # Table 2 of the paper: 13.79 um.
    assert abs(curve.transmission_error_um.mean() - 13.79) < 0.05
    # Statistics are those of the curve between its positions.
    assert abs(curve.transmission_error_um.mean() - curve.statistics["transmission_error_um"]["mean"]) < 5e-3
    assert told[-1] == (200, 200)


def test_a_frame_has_a_row_for_each_torque_and_position(service):
    submission = service.example("standard-pair")
    frame = service.preview(submission).frame()
    assert sorted(frame.output_torque_n_m.unique()) == [20.0, 115.0]
    assert len(frame) == 2 * 40
    assert frame.transmission_error_um.gt(0).all()


def test_what_is_solved_has_its_job_and_a_frame_its_stresses_and_orders(service):
    submission = service.example("test-case-2")
    results = service.solve(submission | {"stress": True})
    assert service.results(results.job.id).document == results.document
    assert results.job.id == results.job["id"] and results.job.status == "successful"
    frame = results.frame()
    # The largest may stand between the positions of the arrays.
    largest = results.curves[0].statistics["stress"]["driven"]["hole_mpa"]
    assert 0.99 * largest < frame.stress_driven_hole_mpa.max() <= largest
    assert "stress_driving_hole_mpa" not in frame
    orders = results.spectrum_frame().set_index("order")
    assert orders.transmission_error_um[10] == pytest.approx(results.curves[0].order("H_N"))
    assert service.preview(submission).job is None


def test_shares_add_up_and_orders_have_names(service):
    curve = service.preview(service.example("test-case-2")).curves[0]
    offsets = [share["pair_offset"] for share in curve.document["load_shares"]]
    assert np.allclose(sum(curve.load_share(offset) for offset in offsets), 1.0, atol=1e-9)
    assert curve.order("H_N") > 0.1
    with pytest.raises(KeyError):
        curve.order("H_99")


def test_a_refusal_names_the_field_and_the_nearest_value(service):
    submission = service.example("bad-case-3-as-printed")
    with pytest.raises(ProblemError) as refused:
        service.solve(submission)
    (error,) = refused.value.errors
    assert (refused.value.code, error.pointer, error.nearest) == ("teeth_do_not_reach", "/pair/center_distance_mm", 115.56)


def test_the_same_calls_can_be_awaited(service):
    async def ask():
        async with AsyncClient() as client:
            submission = await client.example("standard-pair")
            return await asyncio.gather(client.preview(submission), client.solve(submission), client.validate(submission))

    preview, solved, validation = asyncio.run(ask())
    assert preview.document == solved.document
    assert validation["valid"]


def test_a_study_is_a_frame(service):
    base = service.example("test-case-2")
    table = service.study({"base": base, "axes": [{"path": "/pair/driven/blank/holes/count", "values": [6, 40]}]})
    frame = table.frame()
    assert list(frame.status) == ["successful", "failed"]
    assert frame.problem[1]
    assert table.pareto() == [frame.label[0]]
    named = [each for each in service.quantities() if each["of"] == "curve" or each["gear"] in (None, "driven")]
    columns = [each["name"] if each["of"] == "curve" else each["name"].removesuffix(".driven") for each in named]
    assert len(columns) > 20 and set(columns) <= set(frame.columns)
    assert frame.mass_kg[0] > 0 and frame["transmission_error_um.tooth_to_tooth"][0] > 0


def test_a_population_is_what_numpy_makes_of_its_table(service):
    base = service.example("standard-pair") | {"method": "load_distribution"}
    vary = [{"path": "/pair/center_distance_mm", "kind": "normal", "mean": 100.5, "standard_deviation": 0.02, "low": 100.4, "high": 100.6}]
    asked = {"size": 400, "vary": vary, "accuracy": {"driving": {"iso_1328_class": 6}, "driven": {"iso_1328_class": 6}}}
    table = service.study({"base": base, "population": asked, "keep": "statistics"})
    members = table.frame()
    spread = table.population().frame()
    for torque, of_torque in members.groupby("output_torque_n_m"):
        lines = [line for line in spread.to_dict("records") if line["output_torque_n_m"] == torque]
        assert {"transmission_error_um.mean", "mesh_stiffness_tangent_n_per_m.mean", "mesh_order_um"} <= {line["name"] for line in lines}
        for told in lines:
            values = of_torque[told["name"]].dropna().to_numpy()
            assert len(values) == told["count"]
            assert np.isclose(told["mean"], np.mean(values), rtol=1e-12)
            assert np.isclose(told["standard_deviation"], np.std(values), rtol=1e-9)
            for percent in (1, 5, 25, 50, 75, 95, 99):
                assert np.isclose(told[f"p{percent}"], np.percentile(values, percent), rtol=1e-12)
                low, high = told[f"p{percent}_low"], told[f"p{percent}_high"]
                # 400 members that are not all independent are at the edge of what carries limits of p1 and p99, which need 367 independent ones.
                assert low <= told[f"p{percent}"] or (percent == 1 and np.isnan(low))
                assert told[f"p{percent}"] <= high or (percent == 99 and np.isnan(high))
    for quantity in table.population().quantities:
        if quantity["name"] == "transmission_error_um.mean":
            histogram = quantity["histogram"]
            values = members[members.output_torque_n_m == quantity["output_torque_n_m"]].mean_um
            counts, _ = np.histogram(values, bins=histogram["edges"])
            assert list(counts) == histogram["counts"]
    assert len(table.population().influences()) >= 3
    with pytest.raises(ValueError):
        service.study({"base": base, "designs": [{"label": "one"}]}).population()


def test_a_search_gives_its_best_design(service):
    base = service.example("standard-pair") | {"method": "load_distribution", "output_torques_n_m": [115]}
    paths = [f"/pair/{gear}/tip_relief/amount_um" for gear in ("driving", "driven")]
    asked = {"variables": [{"path": path, "low": 1, "high": 20, "step": 1} for path in paths], "minimize": [{"quantity": "transmission_error_um.peak_to_peak"}], "evaluations": 30}
    study = service.study({"base": base, "search": asked})
    found = study.search["best"]
    least = study.frame().query("label != 'confirmed'").peak_to_peak_um.min()
    assert found["goals"] == [least]
    best = study.best()
    assert [best["pair"][gear]["tip_relief"]["amount_um"] for gear in ("driving", "driven")] == [found["values"][path] for path in paths]
    asked["minimize"].append({"cost": [{"path": path, "weight": 1} for path in paths]})
    front = service.study({"base": base, "search": asked}).front()
    assert front.goal_1.is_monotonic_increasing and front.goal_2.is_monotonic_decreasing
    with pytest.raises(ValueError):
        service.study({"base": base, "designs": [{"label": "one"}]}).best()


def solved(service):
    job = service.submit(service.example("test-case-2"))
    while job["status"] not in ("successful", "failed"):
        job = service.job(job["id"])
    return job["id"], service.results(job["id"]).curves[0]


def test_a_look_up_table_has_the_curve_over_the_angle_and_closes(service):
    job, curve = solved(service)
    table = service.look_up_table(job)
    assert np.allclose(table.transmission_error_m[:-1] * 1e6, curve.transmission_error_um, rtol=1e-9)
    assert np.isclose(table.driving_angle_rad[-1], np.deg2rad(5 * 360 / 50))
    assert table.mesh_stiffness_n_per_m[0] == table.mesh_stiffness_n_per_m[-1]
    assert table.head["period_mesh_periods"] == "5"
    assert table.head["signs"]


def ross_mesh(ross):
    """Makes a `Mesh` of ROSS, whose module is another one from version 3 on."""
    if int(ross.__version__.split(".")[0]) >= 3:
        from ross.multi_rotor.gear_element import GearElementTVMS
        from ross.multi_rotor.mesh import Mesh
    else:
        from ross.gear_element import GearElementTVMS, Mesh
    gear = {"material": ross.steel, "width": 0.02, "bore_diameter": 0.032, "module": 0.002, "n_teeth": 50, "pr_angle": np.deg2rad(20)}
    driving, driven = (GearElementTVMS(n=node, **gear) for node in (0, 1))
    # As a rotor numbers them, which the backlash model asks.
    driving.dof_global_index, driven.dof_global_index = ({f"dof_{i}": node * 6 + i for i in range(6)} for node in (0, 1))
    return lambda **more: Mesh(driving, driven, gear_mesh_stiffness=1e8, **more)


def test_ross_interpolates_our_stiffness(service):
    ross = pytest.importorskip("ross", reason="NOT CHECKED: ROSS is not installed")
    make = ross_mesh(ross)

    job, curve = solved(service)
    table = service.look_up_table(job)
    mesh = table.to_ross(make())
    # Over several periods, at the positions computed: ROSS wraps where the table ends.
    angles = np.deg2rad(curve["driving_angle_deg"])
    again = [mesh.interpolate_stiffness(angle + table.driving_angle_rad[-1]) for angle in angles[1:]]
    assert np.allclose(again, curve.mesh_stiffness_tangent_n_per_m[1:], rtol=1e-6)
    assert np.isclose(np.mean(curve.mesh_stiffness_tangent_n_per_m), mesh.stiffness, rtol=1e-9)
    if int(ross.__version__.split(".")[0]) >= 3:
        # The force of its backlash model comes from a table of its own.
        backlash = {"enable": True, "initial_value": 1e-4, "error_amp": 0.0, "smooth_operator": False, "sigma": 1e4}
        with pytest.raises(ValueError, match="no effect"):
            table.to_ross(make(backlash=backlash))


def test_exudyn_turns_our_force_table_into_our_curve(service):
    exu = pytest.importorskip("exudyn", reason="Exudyn is not installed")
    from exudyn.itemInterface import NodeGenericODE2, ObjectGenericODE2, SensorNode

    submission = service.example("standard-pair") | {"method": "flexible", "output_torques_n_m": [115.0], "force_table": {}}
    results = service.solve(submission)
    curve, table = results.curves[0], service.force_table(results.job["id"])

    # The driving gear turns slowly, the driven one carries the load: what is left is the static curve.
    load, inertia, damping, speed, end = 115.0, 1e-3, 25.0, 1.257, 0.2
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    lag = curve.transmission_error_um[0] * 1e-6 / table.base_radii_m[1]
    node = mbs.AddNode(NodeGenericODE2(numberOfODE2Coordinates=1, referenceCoordinates=[0.0], initialCoordinates=[-lag], initialCoordinates_t=[speed]))

    def torque(mbs, t, item, q, q_t):
        return [table.torques(speed * t, q[0])[1] - load - damping * (q_t[0] - speed)]

    mbs.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.array([[inertia]]), forceUserFunction=torque))
    sensor = mbs.AddSensor(SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=exu.OutputVariableType.Coordinates))
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = 800, end
    settings.solution.file.write, settings.solution.sensors.writePeriod = False, end / 800
    mbs.SolveDynamic(settings)

    time, driven = mbs.GetSensorStoredData(sensor).T
    one, other = table.base_radii_m
    approach = 1e6 * (one * speed * time - other * driven)
    period = table.driving_angle_rad[-1] - table.driving_angle_rad[0]
    angles = np.append(np.deg2rad(curve["driving_angle_deg"]), period)
    static = np.interp((speed * time) % period, angles, np.append(curve.transmission_error_um, curve.transmission_error_um[0]))
    settled = time > end / 4
    # Where a pair comes to carry, forty positions a mesh period cut the corner of the curve.
    apart = np.abs(approach - static)[settled]
    assert np.median(apart) < 0.02 and apart.max() < 0.3
    assert np.ptp(static[settled]) > 0.5


def test_results_are_plotted(service):
    import matplotlib

    matplotlib.use("Agg")
    axes = service.preview(service.example("standard-pair")).plot()
    assert len(axes.lines) == 2
    assert axes.get_ylabel() == "transmission error in µm"
    assert service.preview(service.example("standard-pair")).plot("mesh_stiffness_tangent_n_per_m").get_ylabel() == "mesh stiffness tangent in N/m"


def test_a_file_that_comes_later_is_asked_for_again_however_often():
    def answers():
        # Busy between: tries of a busy service are counted by themselves.
        told = iter([202] * 9 + [503] + [202] * 9)

        def answer(request):
            status = next(told, 200)
            return httpx.Response(status, headers={"retry-after": "0"}, text="<VTKFile/>" if status == 200 else "")

        return httpx.MockTransport(answer)

    with Client("http://service") as client:
        client._http = httpx.Client(base_url="http://service", transport=answers())
        assert client.fields("job") == "<VTKFile/>"

    async def asynchronous():
        async with AsyncClient("http://service") as client:
            client._http = httpx.AsyncClient(base_url="http://service", transport=answers())
            return await client.fields("job")

    assert asyncio.run(asynchronous()) == "<VTKFile/>"


def test_fields_are_read_back_with_the_stresses_of_the_curve(service, tmp_path):
    submission = service.example("stress")
    curve = service.solve(submission).curves[0]
    job = service.submit(submission)["id"]
    place = 7
    position = float(curve.mesh_position[place])
    file = tmp_path / "fields.vtu"
    file.write_text(service.fields(job, torque=115.0, mesh_position=position))
    grid = meshio.read(file)
    stress, von_mises = grid.point_data["stress_mpa"].reshape(-1, 3, 3), grid.point_data["von_mises_mpa"]
    sxx, syy, sxy = stress[:, 0, 0], stress[:, 1, 1], stress[:, 0, 1]
    assert np.allclose(np.sqrt(sxx**2 - sxx * syy + syy**2 + 3 * sxy**2), von_mises, rtol=1e-3, atol=1e-2)
    # Hubs stand still, and the largest displacement is of the order of the transmission error.
    moved = np.linalg.norm(grid.point_data["displacement_um"], axis=1)
    for center in (0.0, 100.5):
        radius = np.hypot(grid.points[:, 0] - center, grid.points[:, 1])
        assert moved[radius < 15.001].max() == 0.0
    assert 0.3 < moved.max() / curve.transmission_error_um[place] < 3.0
    # The nodes where the curve has its largest stress at a hole are stressed as much: means over elements against the edge itself.
    hole = curve.stress("driven")["hole_mpa"][place]
    x, y = grid.points[:, 0] - 100.5, grid.points[:, 1]
    radius = np.hypot(x, y)
    near_holes = (radius > 34 - 8.386) & (radius < 34 + 8.386)
    assert abs(von_mises[near_holes].max() / hole - 1.0) < 0.03
    assert sorted({int(value) for block in grid.cell_data["gear"] for value in block}) == [0, 1]


def test_fields_along_the_faces_are_volumes_as_stressed_as_the_curve_says(service, tmp_path):
    submission = service.example("helical-pair")
    submission["resolution"] = {"positions_per_mesh_period": 8, "face_order": 4, "face_slices": 20}
    submission["output_torques_n_m"], submission["stress"] = [200.0], True
    results = service.solve(submission)
    curve, place = results.curves[0], 2
    file = tmp_path / "fields.vtu"
    file.write_text(service.fields(results.job["id"], mesh_position=float(curve.mesh_position[place])))
    grid = meshio.read(file)
    assert {block.type for block in grid.cells} == {"hexahedron20"}
    stress = grid.point_data["stress_mpa"].reshape(-1, 3, 3)
    assert np.allclose(stress, stress.transpose(0, 2, 1))
    deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    mises = np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))
    assert np.allclose(mises, grid.point_data["von_mises_mpa"], rtol=1e-3, atol=1e-2)
    # The faces are as wide as drawn and stand in the middle of the common one; hubs stand still.
    of_driven = np.zeros(len(grid.points), dtype=bool)
    for block, gear in zip(grid.cells, grid.cell_data["gear"]):
        of_driven[block.data[gear.ravel() == 1].astype(int)] = True
    driven = np.where(of_driven, np.hypot(grid.points[:, 0] - 95.8, grid.points[:, 1]), np.inf)
    rim = (driven > 56) & (driven < 62)
    assert np.allclose([grid.points[rim, 2].min(), grid.points[rim, 2].max()], [-10.0, 10.0], atol=1e-4)
    moved = np.linalg.norm(grid.point_data["displacement_um"], axis=1)
    assert moved[driven < 20.001].max() == 0.0
    assert 0.1 < moved.max() / curve.transmission_error_um[place] < 3.0
    # About the root circle the stress is that of the curve: means over elements against the surface itself.
    root = curve.stress("driven")["root_tension_mpa"][place]
    near_roots = (driven > 59.9) & (driven < 61.5)
    assert abs(np.linalg.eigvalsh(stress[near_roots])[:, 2].max() / root - 1.0) < 0.06


def test_a_contact_pattern_is_read_and_drawn(service):
    import matplotlib

    matplotlib.use("Agg")
    submission = service.example("helical-pair")
    submission["resolution"] = {"positions_per_mesh_period": 8, "face_order": 4, "face_slices": 20}
    results = service.solve(submission)
    assert all(curve.K_Hbeta == curve.face_load_factor > 1.0 for curve in results.curves)
    for curve in results.curves:
        assert 1.0 <= curve.lead_cure["face_load_factor"] < curve.face_load_factor
    pattern = service.contact_pattern(results.job["id"])
    assert pattern.output_torques_n_m == [200.0, 50.0]
    for gear in ("driving", "driven"):
        pressure = pattern.pressure_mpa(gear)
        assert pressure.shape == (len(pattern.diameter_mm(gear)), len(pattern.z_mm))
        # A sharp edge that carries shows at the tip of its own flank, and at the foot of its mate's.
        assert (pressure > 0.0).mean() > 0.5
    # The lighter load leaves more of the face free.
    alone = service.contact_pattern(results.job["id"], torque=50.0)
    assert (alone.pressure_mpa("driving") > 0.0).sum() < (pattern.pressure_mpa("driving") > 0.0).sum()
    assert np.array_equal(alone.pressure_mpa("driving"), pattern.pressure_mpa("driving", curve=1))
    assert [line["mesh_position"] for line in pattern.lines()] == list(results.curves[0].mesh_position)
    assert pattern.plot().get_xlabel() == "z in mm"
    with pytest.raises(ProblemError) as refused:
        service.contact_pattern(solved(service)[0])
    assert refused.value.code == "not_found"


def test_the_fmu_validates_and_gives_the_loads_of_the_table(service, tmp_path):
    import fmpy
    from fmpy.validation import validate_fmu

    results = service.solve(service.example("run-up"))
    base = os.environ.get("MESHWRIGHT_URL", "http://127.0.0.1:8080")
    file = str(tmp_path / "mesh.fmu")
    urllib.request.urlretrieve(f"{base}/v1/jobs/{results.job['id']}/results/force-table.fmu", file)
    assert validate_fmu(file) == []

    table, pair = results.document["force_table"], results.pair
    r_1, r_2 = (pair[gear]["base_radius_mm"] * 1e-3 for gear in ("driving", "driven"))
    loads, rows = np.array(table["load_n"]), np.array(table["transmission_error_um"]) * 1e-6
    # Through positions and loads of the table, into the backlash, and to the other flank; a revolution later all is as before.
    places = [(0, 3), (17, 11), (101, 6), (199, 1)]
    approaches = [rows[load, position] for position, load in places]
    expected = [loads[load] for _, load in places]
    places += [(40, 0), (40, 0)]
    approaches += [rows[0, 40] - 50e-6, table["other_flank_transmission_error_um"][5][40] * 1e-6]
    expected += [0.0, -loads[5]]
    theta_1 = np.array([2 * np.pi * (1 + table["mesh_position"][position] / 50) for position, _ in places])
    theta_2 = (r_1 * theta_1 - np.array(approaches)) / r_2
    for kind in ("ModelExchange", "CoSimulation"):
        for angle_1, angle_2, approach, load in zip(theta_1, theta_2, approaches, expected):
            columns = [("time", float), ("theta_1_rad", float), ("theta_2_rad", float)]
            inputs = np.array([(0.0, angle_1, angle_2), (1.0, angle_1, angle_2)], dtype=columns)
            outputs = ["torque_1_n_m", "torque_2_n_m", "transmission_error_um"]
            told = fmpy.simulate_fmu(file, fmi_type=kind, input=inputs, output=outputs, stop_time=1.0)[-1]
            assert told["torque_2_n_m"] == pytest.approx(load * r_2, rel=1e-6, abs=1e-6)
            assert told["torque_1_n_m"] == pytest.approx(-load * r_1, rel=0.02, abs=1e-6)
            assert told["transmission_error_um"] == pytest.approx(approach * 1e6, abs=1e-6)


def fmu_of(service, submission, folder):
    """The file of an FMU, and the results that it was made of."""
    results = service.solve(submission)
    base = os.environ.get("MESHWRIGHT_URL", "http://127.0.0.1:8080")
    file = folder / "mesh.fmu"
    urllib.request.urlretrieve(f"{base}/v1/jobs/{results.job.id}/results/force-table.fmu", file)
    return file, results


def test_the_fmu_has_light_loads_to_a_part_of_themselves(service, tmp_path):
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    submission = service.example("standard-pair") | {"method": "flexible", "output_torques_n_m": [115.0]}
    file, results = fmu_of(service, submission | {"force_table": {}}, tmp_path)
    r_1, r_2 = (results.pair[gear]["base_radius_mm"] * 1e-3 for gear in ("driving", "driven"))
    largest = 230.0
    parts = [1e-4, 3e-4, 1e-3, 2e-3, 3e-3, 5e-3, 0.01, 0.03, 0.1]
    direct = service.solve(submission | {"output_torques_n_m": [part * largest for part in parts]})
    described = fmpy.read_model_description(str(file))
    assert "50 and 50 teeth" in described.description and "-230 to 230 N m" in described.description
    model = FMU2Slave(guid=described.guid, unzipDirectory=fmpy.extract(str(file)), modelIdentifier=described.coSimulation.modelIdentifier, instanceName="mesh")
    model.instantiate()
    model.setupExperiment(startTime=0.0)
    model.enterInitializationMode()
    model.exitInitializationMode()
    for part, curve in zip(parts, direct.curves):
        for eta, approach in zip(curve.mesh_position, curve.transmission_error_um):
            theta_1 = 2 * np.pi * eta / 50
            model.setReal([0, 1], [theta_1, (r_1 * theta_1 - approach * 1e-6) / r_2])
            found = model.getReal([3])[0] / largest
            # Below 1/500 as many parts of the largest as that is of 1/500.
            assert abs(found - part) < (0.01 * part if part >= 2e-3 else 2e-5), (part, eta, found)
    model.terminate()
    model.freeInstance()


def test_libcosim_steps_the_fmu(service, tmp_path):
    pytest.importorskip("libcosimpy", reason="NOT CHECKED: libcosimpy cannot be had here")
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    file, results = fmu_of(service, service.example("run-up"), tmp_path)
    table, (r_1, r_2) = results.document["force_table"], (results.pair[gear]["base_radius_mm"] * 1e-3 for gear in ("driving", "driven"))
    execution = CosimExecution.from_step_size(step_size=1_000_000)
    slave = execution.add_local_slave(local_slave=CosimLocalSlave(fmu_path=str(file), instance_name="mesh"))
    manipulator, observer = CosimManipulator.create_override(), CosimObserver.create_last_value()
    execution.add_manipulator(manipulator)
    execution.add_observer(observer)
    for position, load in [(17, 5), (40, 9)]:
        approach = table["transmission_error_um"][load][position]
        theta_1 = 2 * np.pi * table["mesh_position"][position] / 50
        manipulator.slave_real_values(slave_index=slave, variable_references=[0, 1], values=[theta_1, (r_1 * theta_1 - approach * 1e-6) / r_2])
        assert execution.step()
        told = observer.last_real_values(slave_index=slave, variable_references=[3, 4])
        assert told == pytest.approx([table["load_n"][load] * r_2, approach], rel=1e-6)


# What the package takes of the Modelica library. No package of Debian or PyPI brings a compiler with the library itself.
LIBRARY = """
package Modelica
  package Mechanics
    package Rotational
      package Interfaces
        connector Flange_a Real phi; flow Real tau; end Flange_a;
        connector Flange_b Real phi; flow Real tau; end Flange_b;
      end Interfaces;
    end Rotational;
  end Mechanics;
  package Blocks
    package Types
      type Extrapolation = enumeration(HoldLastPoint, LastTwoPoints, Periodic, NoExtrapolation);
    end Types;
    package Tables
      block CombiTable2Ds
        parameter Real table[:, :];
        parameter Modelica.Blocks.Types.Extrapolation extrapolation;
        Real u1; Real u2; Real y;
      end CombiTable2Ds;
    end Tables;
  end Blocks;
end Modelica;
"""


def test_the_modelica_package_is_a_whole_model_whose_table_has_the_loads(service):
    from pymoca import ast, parser, tree

    submission = service.example("standard-pair")
    submission |= {"force_table": {}, "resolution": {"positions_per_mesh_period": 8, "grid": "coarse"}}
    results = service.solve(submission)
    base = os.environ.get("MESHWRIGHT_URL", "http://127.0.0.1:8080")
    with urllib.request.urlopen(f"{base}/v1/jobs/{results.job['id']}/results/force-table.mo") as answer:
        text = answer.read().decode()
    models = parser.parse(LIBRARY)
    models.extend(parser.parse(text))
    mesh = tree.flatten(models, ast.ComponentRef.from_string("MeshwrightMesh.Mesh")).classes["MeshwrightMesh.Mesh"]
    unknowns = [each for each in mesh.symbols.values() if not {"constant", "parameter"} & set(each.prefixes)]
    # Each table has an equation of its own.
    assert len(unknowns) == len(mesh.equations) + 2

    matrix = text.split("force[:,:] = [")[1].split("]")[0]
    rows = np.array([[float(cell) for cell in row.split(",")] for row in matrix.split(";")])
    angles, approaches = rows[1:, 0], rows[0, 1:]
    table = results.document["force_table"]
    for position, eta in enumerate(table["mesh_position"]):
        row = rows[1 + np.argmin(abs(angles - 2 * np.pi * eta / 50)), 1:]
        for load, deltas in zip(table["load_n"], table["transmission_error_um"]):
            # Straight lines between columns.
            assert np.interp(deltas[position] * 1e-6, approaches, row) == pytest.approx(load, abs=2e-3 * table["load_n"][-1])


def test_who_finds_no_service_is_told_where_it_was_sought():
    # Nobody listens at the first port.
    address = "http://127.0.0.1:1"
    with Client(address) as client, pytest.raises(httpx.ConnectError, match=address):
        client.examples()

    async def ask():
        async with AsyncClient(address) as client:
            await client.examples()

    with pytest.raises(httpx.ConnectError, match=address):
        asyncio.run(ask())
