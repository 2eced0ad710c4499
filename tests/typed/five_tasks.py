"""A user's script: from a scan to a law, a structure and a result, with what each of them shows."""

import faying

# a scan
scan = faying.read_scan("examples/t-specimen/milled.x3p")
print(scan)
print(scan.Sq, scan.roughness().Sdq)
scan.plot()
fit = scan.fractal()
print(fit.D, fit.G, fit.G_interval)
fit.plot()

# a law of two such faces
faces = faying.Mates(scan, materials="45 steel")
law = faces.law()
print(law)
print(law.at_pressure("5 MPa").k_n, law.at_pressure(5e6).k_load)
law.plot()
jk = faces.law("jk", alpha=0.3)
print(jk.at_pressure("5 MPa").k_n / law.at_pressure("5 MPa").k_n)

# all laws of these faces
table = faces.compare()
print(table.sel(pressure=5e6, method="nearest").k_n.to_series())
faces.compare_plot()

# a structure
mesh = faying.read_mesh("examples/t-specimen/t-specimen.step", size="18 mm")
print(mesh)
structure = faying.Structure(
    mesh,
    materials="45 steel",
    joints=[faying.Joint(("upper.joint", "lower.joint"), law)],
    bolts=[
        faying.Bolt("left", ("upper.seat.left", "lower.seat.left")),
        faying.Bolt("right", ("upper.seat.right", "lower.seat.right")),
    ],
)
structure.plot()
state = structure.solve(preload="8 kN", modes=15)
print(state.modes.frequencies, state.modes.damping)
state.plot_pressure()
state.modes.plot(1)

# a result
result = faying.run("examples/t-specimen/study.toml")
print(result)
print(result.to_dataframe("modes").head())
result.plot()
result.save("t-specimen.nc")
again = faying.load("t-specimen.nc")
assert again == result
tree = again.to_xarray()
print(tree["modes"].frequency.sel(load="8 kN"))
