"""A user's script: a scan, a law of it, laws next to each other. It runs, and type checkers accept it."""

import faying

scan = faying.read_scan("examples/t-specimen/milled.x3p")
print(scan)
print(scan.Sq, scan.roughness().Sdq)
scan.plot()
fit = scan.fractal()
print(fit.D, fit.G, fit.G_interval)
fit.plot()

faces = faying.Mates(scan, materials="45 steel")
law = faces.law()
print(faces)
print(law)
print(law.at_pressure("5 MPa").k_n, law.at_pressure(5e6).k_load)
law.plot()
jk = faces.law("jk", alpha=0.3)
print(jk.at_pressure("5 MPa").k_n / law.at_pressure("5 MPa").k_n)

table = faces.compare()
print(table.sel(pressure=5e6, method="nearest").k_n.to_series())
faces.compare_plot()

response: faying.Response = law.at_pressure([1e6, 5e6])
print(response)
pair = faying.ContactPair("45 steel", "rigid")
own = faying.Material(name="own", E=210e9, nu=0.3, yield_strength=400e6)
print(faying.JK(D=fit.D, G=fit.surface_G, scan_area=16e-6, pair=faying.ContactPair(own, own)), pair)
