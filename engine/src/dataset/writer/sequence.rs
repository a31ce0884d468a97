//! What concerns a whole sequence: lists, previews on one scale, overviews, card, manifest.

use rayon::prelude::*;

use super::{ANIMATION_PIXELS, SHEET_EXPOSURES, SHEET_PIXELS, Writer, pretty};
use crate::dataset::card::Card;
use crate::dataset::error::DatasetError;
use crate::dataset::folder::{ANIMATION, CARD, Folder, MANIFEST, POSES, SHEET, name};
use crate::dataset::format::Format;
use crate::dataset::manifest::{Manifest, ManifestEntry, PreviewScale};
use crate::dataset::preview::{self, Thumbnail};
use crate::dataset::record::{ExposureMetadata, FileRecord, PreviewRecord, Record, SCHEMA_VERSION};
use crate::dataset::{animation, coco, contact_sheet, png_file, poses, sequences};

impl Writer {
    pub(super) fn write_sequence(
        &mut self,
        records: &mut [(usize, Record)],
    ) -> Result<Option<PreviewScale>, DatasetError> {
        let of_run = |manifest: &Manifest| manifest.run_key == self.output.key;
        let other = Folder::read_manifest(&self.output.directory).filter(of_run);
        self.planned = self.planned.max(other.map_or(0, |manifest| manifest.exposures_planned));
        let plain: Vec<Record> = records.iter().map(|(_, record)| record.clone()).collect();
        let scale = preview::scale(&plain, self.settings.white);
        let mut files = vec![self.output.write(POSES, poses::csv(&plain).as_bytes())?];
        let facts: Vec<&ExposureMetadata> = plain.iter().map(|record| &record.facts).collect();
        for (name, text) in sequences::files(&self.settings.formats, &self.run.name, &facts) {
            files.push(self.output.write(&name, text.as_bytes())?);
        }
        files.extend(self.annotations(records)?);
        if let Some(scale) = &scale {
            let step = records.len().div_ceil(SHEET_EXPOSURES).max(1);
            let previews: Vec<(usize, Option<Thumbnail>)> = records
                .par_iter_mut()
                .enumerate()
                .map(|(place, (index, record))| {
                    let shown = self.settings.animation || place % step == 0;
                    Ok((*index, self.output.preview(*index, record, scale, shown)?))
                })
                .collect::<Result<_, DatasetError>>()?;
            files.extend(self.overviews(&previews, scale)?);
        }
        let card = Card {
            run: &self.run,
            records: &plain,
            planned: self.planned,
            preview: scale.as_ref(),
            formats: &self.settings.formats,
            tiff: self.settings.tiff,
        };
        files.push(self.output.write(CARD, card.text().as_bytes())?);
        self.manifest(records, scale.clone(), files)?;
        Ok(scale)
    }

    /// The landmarks of all exposures in the formats asked for.
    fn annotations(&self, records: &[(usize, Record)]) -> Result<Vec<FileRecord>, DatasetError> {
        let formats = &self.settings.formats;
        if ![Format::Coco, Format::CraterChallenge].iter().any(|format| formats.contains(format)) {
            return Ok(Vec::new());
        }
        let mut images = Vec::new();
        for (index, _) in records {
            if let Some(file) = self.output.landmarks(*index)? {
                images.push((*index, name(*index, "png"), file));
            }
        }
        let mut files = Vec::new();
        if formats.contains(&Format::Coco) {
            files.push(self.output.write(coco::FILE, &pretty(&coco::annotations(&self.run.title, &images)))?);
        }
        if formats.contains(&Format::CraterChallenge) {
            files.push(self.output.write(coco::CSV_FILE, coco::challenge_csv(&images).as_bytes())?);
        }
        Ok(files)
    }

    fn overviews(
        &self,
        previews: &[(usize, Option<Thumbnail>)],
        scale: &PreviewScale,
    ) -> Result<Vec<FileRecord>, DatasetError> {
        let step = previews.len().div_ceil(SHEET_EXPOSURES).max(1);
        let reduced =
            |(index, frame): &(usize, Option<Thumbnail>)| Some((*index, frame.as_ref()?.reduced(SHEET_PIXELS)));
        let shown: Vec<_> = previews.iter().step_by(step).filter_map(reduced).collect();
        let sheet = contact_sheet::sheet(&shown);
        let path = self.output.path(SHEET);
        let comment = preview::comment(scale);
        let bytes = png_file::encode_8(&path, [sheet.columns, sheet.rows], &sheet.grey, &comment)?;
        let mut files = vec![self.output.write(SHEET, &bytes)?];
        if self.settings.animation {
            let frames: Vec<_> = previews
                .iter()
                .filter_map(|(index, frame)| Some((*index, frame.as_ref()?.reduced(ANIMATION_PIXELS))))
                .collect();
            files.push(self.output.write(ANIMATION, &animation::encode(&self.output.path(ANIMATION), &frames)?)?);
        }
        Ok(files)
    }

    pub(super) fn manifest(
        &self,
        records: &[(usize, Record)],
        preview: Option<PreviewScale>,
        files: Vec<FileRecord>,
    ) -> Result<(), DatasetError> {
        let entry = |(index, record): &(usize, Record)| {
            let json = FileRecord::of(&name(*index, "json"), record.text().as_bytes());
            let preview = record.preview.iter().flat_map(PreviewRecord::files).cloned();
            ManifestEntry {
                index: *index,
                epoch_utc: record.facts.epoch.utc.clone(),
                point: record.facts.sweep.as_ref().map(|sweep| sweep.point),
                split: record.facts.split.as_ref().map(|split| split.part.clone()),
                warnings: record.facts.quality.warnings.clone(),
                files: record.files.iter().cloned().chain(preview).chain([json]).collect(),
            }
        };
        let manifest = Manifest {
            schema_version: SCHEMA_VERSION.into(),
            run_key: self.output.key.clone(),
            run: self.run.clone(),
            exposures_planned: self.planned,
            preview,
            exposures: records.iter().map(entry).collect(),
            files,
            sha256: String::new(),
        };
        self.output.write(MANIFEST, manifest.text().as_bytes()).map(|_| ())
    }
}
