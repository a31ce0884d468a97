//! The exposures of a run: rendering here, planes beside it, encoding and writing beside both.
//!
//! ```text
//! this thread       session --samples-->
//! one other                              planes, map, record --image-->
//! the writer's                                                        encode, hash, write
//! ```
//!
//! What waits between two stages is bounded: one exposure's samples and two images. Who is behind holds up who is before; an
//! error of a later stage ends the earlier ones at their next exposure and is what the run reports.

use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

use super::capture::{self, CapturedExposure};
use super::sequence::Before;
use super::watch::Watch;
use super::{Error, Prepared, Progress, ortho, record, sequence};
use crate::dataset::{self, Format, Writer};
use crate::labels;
use crate::render::planes::Radiometry;
use crate::render::{Imaging, RenderError, Scene, Session, reference};

/// Exposures whose samples wait for their planes.
const QUEUE: usize = 1;

/// Where the time of the images went, each stage on its own thread.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spent {
    /// Rendered exposures.
    pub exposures: usize,
    pub samples: Duration,
    /// Planes, maps and records.
    pub planes: Duration,
    /// Of the device, where it can tell.
    pub device: Duration,
}

/// What the session hands on.
struct Sampled {
    index: usize,
    captured: CapturedExposure,
    /// What the exposure before sampled, where a label needs it.
    before: Option<Vec<Radiometry>>,
}

/// What takes the images.
pub struct Instrument<'a> {
    pub imaging: &'a Imaging,
    pub session: Session,
}

/// Renders the exposures `todo` and hands them to `writer`; where `resume`, not those that another process has finished meanwhile.
pub fn render(
    prepared: &Prepared,
    Instrument { imaging, mut session }: Instrument,
    writer: &mut Writer,
    todo: &[usize],
    watch: &Watch,
    resume: bool,
    progress: &dyn Progress,
) -> Result<Spent, Error> {
    let scene = session.scene().clone();
    let run = &writer.run().clone();
    let kept = writer.reader();
    std::thread::scope(|scope| {
        let (sender, receiver) = sync_channel::<Sampled>(QUEUE);
        let finisher = scope.spawn(|| {
            let mut spent = Duration::ZERO;
            for sampled in receiver {
                let start = Instant::now();
                let mut exposure = exposure(prepared, &scene, run, &sampled)?;
                watch.note(prepared, &sampled.captured, &mut exposure, progress)?;
                spent += start.elapsed();
                writer.submit(exposure)?;
            }
            Ok::<_, Error>(spent)
        });
        let mut spent = Spent::default();
        let mut before = Before::default();
        let mut sampled = |index: usize| {
            let exposure = &prepared.exposures[index];
            let start = Instant::now();
            let earlier = before.pixels(&mut session, &prepared.exposures, index)?;
            let captured = capture::take(prepared, imaging, &mut session, exposure)?;
            if let Some(samples) = captured.light.samples() {
                before.keep(&exposure.view, index, samples);
            }
            spent.samples += start.elapsed();
            spent.device += captured.light.device;
            Ok::<_, Error>(Sampled { index, captured, before: earlier })
        };
        let mut rendered = Ok(());
        let mut exposures = 0;
        for (count, &index) in todo.iter().enumerate() {
            if resume && kept.is_done(index) {
                progress.at(count + 1, todo.len());
                continue;
            }
            exposures += 1;
            let sent = match sampled(index) {
                Ok(sampled) => sender.send(sampled),
                Err(error) => {
                    rendered = Err(error);
                    break;
                }
            };
            // Later stages that have ended say why below.
            if sent.is_err() {
                break;
            }
            progress.at(count + 1, todo.len());
        }
        drop(sender);
        spent.planes = finisher.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        rendered.map(|()| Spent { exposures, ..spent })
    })
}

/// All that is written of an exposure.
fn exposure(
    prepared: &Prepared,
    scene: &Scene,
    run: &dataset::Run,
    sampled: &Sampled,
) -> Result<dataset::Exposure, Error> {
    let Sampled { index, captured, before } = sampled;
    let index = *index;
    let Prepared { exposures, points, craters, ground, .. } = prepared;
    let view = &exposures[index].view;
    let point = &points[exposures[index].point];
    let mut image = captured.image(scene);
    let shadow = match capture::needs_light(point, view) {
        true => reference::shadow(scene, view, &captured.skylines).map_err(RenderError::from)?,
        false => None,
    };
    let shadow = shadow.as_deref();
    if let Some(samples) = captured.light.samples() {
        image.planes.extend(sequence::planes(point, scene, exposures, index, samples, before.as_deref(), shadow));
    }
    let facts = record::facts(prepared, scene, run, index, &image, captured);
    let on_map = point.outputs.formats.contains(&Format::GeoTiff);
    let orthoimage = on_map
        .then(|| ortho::orthoimage(scene, ground.map.as_ref(), ground.centre, view, &image))
        .transpose()?
        .flatten();
    let wanted = point.landmarks.as_ref().map(|landmarks| &landmarks.wanted);
    let landmarks = wanted.map(|wanted| labels::landmarks(scene, view, shadow, craters, wanted));
    Ok(dataset::Exposure { index, image, facts, landmarks, orthoimage })
}
