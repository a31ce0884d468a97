use super::*;

fn radiance_factor(law: Reflectance, phase_deg: f64, incidence_deg: f64, emission_deg: f64) -> f64 {
    let [phase, incidence, emission] = [phase_deg, incidence_deg, emission_deg].map(|x: f64| x.to_radians().cos());
    law.radiance_factor(incidence, emission, phase)
}

fn laws() -> [Reflectance; 9] {
    [
        Reflectance::Lambert { normal_albedo: 0.12 },
        Reflectance::LommelSeeliger { normal_albedo: 0.12 },
        Reflectance::LunarLambert { normal_albedo: 0.12 },
        Reflectance::Minnaert { normal_albedo: 0.12, exponent: 0.7 },
        Reflectance::Akimov { normal_albedo: 0.12, smoothness: 1.0 },
        Reflectance::Akimov { normal_albedo: 0.12, smoothness: 0.34 },
        Reflectance::Hapke(Hapke::moon()),
        Reflectance::Hapke(Hapke { coherent_amplitude: 0.5, coherent_width: 0.05, ..Hapke::moon() }),
        Reflectance::Hapke(Hapke { filling_factor: 0.3, mean_slope_rad: 0.0, ..Hapke::moon() }),
    ]
}

/// USGS ISIS, `Hapke.truth`: six digits.
#[test]
fn hapke_gives_the_values_of_isis() {
    let plain = Hapke {
        single_scattering_albedo: 0.5,
        asymmetry: 0.0,
        backscatter: 0.0,
        shadow_hiding_amplitude: 0.0,
        shadow_hiding_width: 0.0,
        coherent_amplitude: 0.0,
        coherent_width: 0.0,
        mean_slope_rad: 0.0,
        filling_factor: 0.0,
        multiple_scattering: MultipleScattering::Hapke1981,
        scale: 1.0,
    };
    let rough = Hapke {
        single_scattering_albedo: 0.52,
        shadow_hiding_amplitude: 1.0,
        shadow_hiding_width: 1.0,
        mean_slope_rad: 30f64.to_radians(),
        ..plain
    };
    let mars = Hapke { asymmetry: 0.213, backscatter: 1.0, ..rough };
    for (hapke, overhead, oblique) in
        [(plain, 0.0965097, 0.0832883), (mars, 0.286048, 0.1342), (rough, 0.16145, 0.111525)]
    {
        let law = Reflectance::Hapke(hapke);
        assert!((radiance_factor(law, 0.0, 0.0, 0.0) / overhead - 1.0).abs() < 3e-6, "{hapke:?}");
        assert!((radiance_factor(law, 60.0, 45.0, 30.0) / oblique - 1.0).abs() < 5e-6, "{hapke:?}");
    }
}

/// An independent program's values with the same parameters, three digits.
#[test]
fn the_moon_has_its_radiance_factor() {
    let moon = Reflectance::Hapke(Hapke::moon());
    let table = [
        (0.0, 0.0, 0.0, 0.1890),
        (5.0, 0.0, 5.0, 0.1448),
        (10.0, 0.0, 10.0, 0.1232),
        (30.0, 0.0, 30.0, 0.0812),
        (45.0, 0.0, 45.0, 0.0587),
        (60.0, 0.0, 60.0, 0.0374),
        (60.0, 30.0, 90.0, 0.0313),
        (85.0, 0.0, 85.0, 0.0059),
        (88.5, 0.0, 88.5, 0.00177),
    ];
    for (incidence_deg, emission_deg, phase_deg, expected) in table {
        let got = radiance_factor(moon, phase_deg, incidence_deg, emission_deg);
        assert!((got - expected).abs() < 6e-5, "{incidence_deg} {emission_deg} {phase_deg}: {got}");
    }
}

#[test]
fn the_lunar_lambert_weight_is_that_of_isis() {
    let table = [1.0, 0.8327, 0.7051, 0.6084, 0.5338, 0.4725, 0.4158, 0.3550, 0.2813, 0.1859, 0.0600, 0.0, 0.0];
    for (i, weight) in (0..).zip(table) {
        let phase_deg = 10.0 * f64::from(i);
        assert!((lunar_lambert_weight(phase_deg) - weight).abs() < 6e-5, "{phase_deg} deg");
    }
}

#[test]
fn empirical_laws_have_their_normal_albedo_at_vertical_opposition() {
    for law in &laws()[..6] {
        assert!((radiance_factor(*law, 0.0, 0.0, 0.0) - 0.12).abs() < 1e-12, "{law:?}");
    }
}

/// `D = cos(g/2) cos[π/(π − g) (c − g/2)] (cos b)^(η g/(π − g)) / cos c` as printed, from latitude and longitude.
#[test]
fn akimov_law_is_the_printed_one() {
    for smoothness in [1.0, 0.34] {
        let law = Reflectance::Akimov { normal_albedo: 1.0, smoothness };
        for phase_deg in [0.0f64, 1.0, 30.0, 90.0, 150.0] {
            let g = phase_deg.to_radians();
            for latitude_deg in [0.0f64, 20.0, 70.0] {
                for share in [-0.99, -0.4, 0.0, 0.6, 0.99] {
                    // From limb to terminator.
                    let (b, c) = (latitude_deg.to_radians(), g / 2.0 + share * (PI - g) / 2.0);
                    let printed = (g / 2.0).cos()
                        * (PI / (PI - g) * (c - g / 2.0)).cos()
                        * b.cos().powf(smoothness * g / (PI - g))
                        / c.cos();
                    let got = law.radiance_factor(b.cos() * (c - g).cos(), b.cos() * c.cos(), g.cos());
                    let what = format!("{smoothness} {phase_deg} {latitude_deg} {share}: {got} {printed}");
                    assert!((got - printed).abs() < 1e-9 * (1.0 + printed), "{what}");
                }
            }
        }
    }
}

/// The full Moon is flat, the law 1 at the mirror point's meridian over cos(g/2), and 0 at the terminator.
#[test]
fn akimov_law_has_its_limits() {
    let law = Reflectance::Akimov { normal_albedo: 0.1, smoothness: 1.0 };
    for edge in [0.01, 0.3, 1.0] {
        assert!((law.radiance_factor(edge, edge, 1.0) - 0.1).abs() < 1e-9, "{edge}");
    }
    let g = 1.0f64;
    assert!((law.radiance_factor((g / 2.0).cos(), (g / 2.0).cos(), g.cos()) - 0.1).abs() < 1e-12);
    assert!(law.radiance_factor(1e-5, g.sin(), g.cos()) < 1e-5);
}

/// `p Φ = A cos(g/2) 2(π − g)/π² ∫ cos^(2 + η g/(π − g)) b db`, separable in latitude and longitude.
#[test]
fn a_sphere_of_akimov_law_has_its_closed_phase_curve() {
    let rule = gauss_legendre(96);
    for (index, smoothness) in [(4, 1.0), (5, 0.34)] {
        for phase_deg in [0.5f64, 30.0, 90.0, 150.0] {
            let g = phase_deg.to_radians();
            let power = 2.0 + smoothness * g / (PI - g);
            let latitudes = integrate(&rule, -PI / 2.0, PI / 2.0, |b| b.cos().powf(power));
            let expected = 0.12 * (g / 2.0).cos() * 2.0 * (PI - g) / (PI * PI) * latitudes;
            let got = laws()[index].disc_reflectance(g);
            assert!((got / expected - 1.0).abs() < 1e-6, "{smoothness} {phase_deg}: {got} {expected}");
        }
    }
}

#[test]
fn the_moon_scatters_back_more_than_forward() {
    let moon = Reflectance::Hapke(Hapke::moon());
    assert!(radiance_factor(moon, 0.0, 45.0, 45.0) > 2.0 * radiance_factor(moon, 90.0, 45.0, 45.0));
}

#[test]
fn spheres_of_lambert_and_lommel_seeliger_have_their_closed_phase_curves() {
    for phase_deg in [1.0f64, 30.0, 90.0, 150.0] {
        let g = phase_deg.to_radians();
        let lambert = 2.0 / 3.0 * 0.12 * (g.sin() + (PI - g) * g.cos()) / PI;
        let seeliger = 0.12 * (1.0 - (g / 2.0).sin() * (g / 2.0).tan() * (1.0 / (g / 4.0).tan()).ln());
        assert!((laws()[0].disc_reflectance(g) / lambert - 1.0).abs() < 1e-6, "{phase_deg}");
        assert!((laws()[1].disc_reflectance(g) / seeliger - 1.0).abs() < 1e-4, "{phase_deg}");
    }
}

/// ROLO at 665 nm, mean of waxing and waning (Kieffer & Stone 2005, AJ 129, 2887): within 5 %, the scatter
/// of published lunar sets.
#[test]
fn the_moon_as_a_whole_is_as_bright_as_rolo_saw_it() {
    let table = [(2.0f64, 0.159), (7.0, 0.1227), (30.0, 0.068), (60.0, 0.033), (90.0, 0.0135)];
    for (phase_deg, rolo) in table {
        let disc = Reflectance::Hapke(Hapke::moon()).disc_reflectance(phase_deg.to_radians());
        assert!((disc / rolo - 1.0).abs() < 0.05, "{phase_deg}: {disc}");
    }
}

#[test]
fn parameters_outside_their_domain_are_named() {
    let error = Reflectance::Hapke(Hapke { asymmetry: 1.2, ..Hapke::moon() }).check().unwrap_err();
    assert_eq!(error.to_string(), "asymmetry = 1.2 is outside [0, 0.95]");
    assert!(Reflectance::Lambert { normal_albedo: f64::NAN }.check().is_err());
    assert!(Reflectance::Minnaert { normal_albedo: 0.1, exponent: 0.1 }.check().is_err());
    assert!(laws().iter().all(|law| law.check().is_ok()));
}
