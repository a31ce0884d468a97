use super::*;
use crate::photometry::lunar_disc_reflectance;

fn radiance_factor(law: Reflectance, phase_deg: f64, incidence_deg: f64, emission_deg: f64) -> f64 {
    let [phase, incidence, emission] = [phase_deg, incidence_deg, emission_deg].map(|x: f64| x.to_radians().cos());
    law.radiance_factor(incidence, emission, phase)
}

fn laws() -> [Reflectance; 9] {
    [
        Reflectance::lambert(0.12),
        Reflectance::empirical(0.12, DiscFunction::LommelSeeliger),
        Reflectance::empirical(0.12, DiscFunction::LunarLambert),
        Reflectance::empirical(0.12, DiscFunction::Minnaert { exponent: 0.7 }),
        Reflectance::empirical(0.12, DiscFunction::Akimov { smoothness: 1.0 }),
        Reflectance::empirical(0.12, DiscFunction::Akimov { smoothness: 0.34 }),
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
fn empirical_laws_have_their_normal_albedo_at_vertical_opposition() {
    for law in &laws()[..6] {
        assert!((radiance_factor(*law, 0.0, 0.0, 0.0) - 0.12).abs() < 1e-12, "{law:?}");
    }
}

/// `D = cos(g/2) cos[π/(π − g) (c − g/2)] (cos b)^(η g/(π − g)) / cos c` as printed, from latitude and longitude.
#[test]
fn akimov_law_is_the_printed_one() {
    for smoothness in [1.0, 0.34] {
        let law = Reflectance::empirical(1.0, DiscFunction::Akimov { smoothness });
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
    let law = Reflectance::empirical(0.1, DiscFunction::Akimov { smoothness: 1.0 });
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
    for law in lunar_laws().into_iter().chain([Reflectance::Hapke(Hapke::moon())]) {
        for (phase_deg, rolo) in table {
            let disc = law.disc_reflectance(phase_deg.to_radians());
            assert!((disc / rolo - 1.0).abs() < 0.05, "{law:?} {phase_deg}: {disc}");
        }
    }
    let without = Reflectance::empirical(0.19, DiscFunction::LunarLambert).disc_reflectance(60f64.to_radians());
    assert!(without > 2.0 * 0.033, "{without}");
}

/// The laws with the Moon's phase function, and the albedo that makes ROLO's disc in opposition.
fn lunar_laws() -> Vec<Reflectance> {
    let minnaert = DiscFunction::Minnaert { exponent: 0.5 };
    let akimov = [1.0, 0.34].map(|smoothness| DiscFunction::Akimov { smoothness });
    [DiscFunction::LommelSeeliger, DiscFunction::LunarLambert, minnaert]
        .into_iter()
        .chain(akimov)
        .map(|disc| Reflectance::lunar(0.191, disc).unwrap())
        .collect()
}

/// LROC's law of 2019, fitted from 15 to 65° to another instrument's images: discs of the two within 10 % from 5 to 90°.
#[test]
fn the_moon_as_a_whole_is_as_bright_as_lroc_saw_it() {
    let lroc = Reflectance::LrocNac2019 { scale: 1.0 };
    for law in lunar_laws() {
        for phase_deg in [5.0f64, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0] {
            let [ours, theirs] = [law, lroc].map(|law| law.disc_reflectance(phase_deg.to_radians()));
            assert!((ours / theirs - 1.0).abs() < 0.1, "{law:?} {phase_deg}: {ours} {theirs}");
        }
    }
}

/// Two points of `lronacpho`'s formula, worked out by another program.
#[test]
fn the_law_of_lroc_is_the_printed_one() {
    let lroc = Reflectance::LrocNac2019 { scale: 1.0 };
    for (phase, incidence, emission, expected) in [(30.0, 30.0, 0.0, 0.0876), (60.0, 60.0, 0.0, 0.0422)] {
        let got = radiance_factor(lroc, phase, incidence, emission);
        assert!((got - expected).abs() < 6e-5, "{phase}: {got}");
    }
}

/// The fit of six terms against the ratio that it stands for.
#[test]
fn the_lunar_phase_function_is_the_ratio_to_the_disc_function() {
    for law in lunar_laws() {
        let at_10 = law.disc_reflectance(10f64.to_radians()) / lunar_disc_reflectance(10f64.to_radians());
        for phase_deg in (1..=130).map(f64::from) {
            let phase_rad = phase_deg.to_radians();
            let ratio = law.disc_reflectance(phase_rad) / lunar_disc_reflectance(phase_rad) / at_10;
            let bound = if phase_deg <= 97.0 { 0.012 } else { 0.06 };
            assert!((ratio - 1.0).abs() < bound, "{law:?} {phase_deg}: {ratio}");
        }
    }
}

#[test]
fn parameters_outside_their_domain_are_named() {
    let error = Reflectance::Hapke(Hapke { asymmetry: 1.2, ..Hapke::moon() }).check().unwrap_err();
    assert_eq!(error.to_string(), "asymmetry = 1.2 is outside [0, 0.95]");
    assert!(Reflectance::lambert(f64::NAN).check().is_err());
    assert!(Reflectance::empirical(0.1, DiscFunction::Minnaert { exponent: 0.1 }).check().is_err());
    assert!(laws().iter().all(|law| law.check().is_ok()));
}
