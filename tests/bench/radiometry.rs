//! Light against published values, row by row.

use perilune_bench::radiometry::{ECLIPSES, rows, run};

use crate::fixtures;

#[test]
fn every_row_of_light_agrees_with_what_was_published() {
    let rows = rows(&[fixtures::data_folder()]).unwrap();
    let failed: Vec<_> = rows.iter().filter(|row| !row.holds()).collect();
    for row in &rows {
        println!("{:.6e} {:.6e} {:+.1e} {}", row.ours, row.reference, row.ours - row.reference, row.quantity);
    }
    assert!(failed.is_empty(), "{failed:#?}");
    let contacts = rows.iter().filter(|row| row.unit == "s").count();
    if contacts == 0 {
        println!("skipped: no kernels, no contacts of eclipses");
    } else {
        assert_eq!(contacts, 6 * ECLIPSES.len());
    }
    // The middle between first and last contact does not depend on the size of the Earth's shadow.
    for eclipse in rows.iter().filter(|row| row.unit == "s").collect::<Vec<_>>().chunks(6) {
        for (first, last) in [(0, 5), (1, 4), (2, 3)] {
            let middle_s = (eclipse[first].ours + eclipse[last].ours) / 2.0;
            assert!(middle_s.abs() < 3.0, "{}: {middle_s} s", eclipse[first].quantity);
        }
    }
}

#[test]
fn the_report_holds_a_row_for_each_check_and_says_what_is_left_out() {
    let report = run(&[]).unwrap();
    assert_eq!(report.tables[0].rows.len(), rows(&[]).unwrap().len());
    assert!(report.notes.iter().any(|note| note.contains("no folder holds")), "{:?}", report.notes);
    assert!(report.text().contains("0 of them beyond what is allowed"));
}
