//! The exposures of a run: rendering here, planes beside it, encoding and writing beside both.
//!
//! ```text
//! this thread       renderer --samples-->
//! one other                              planes, map, record --image-->
//! the writer's                                                        encode, hash, write
//! ```
//!
//! What waits between two stages is bounded: one exposure's samples and two images. Who is behind holds up who is before; an
//! error of a later stage ends the earlier ones at their next exposure and is what the run reports.

use std::sync::mpsc::sync_channel;
use std::sync::{PoisonError, RwLock};
use std::time::{Duration, Instant};

use super::{Error, Prepared, Progress, ortho, record, scene};
use crate::dataset::{self, Format, Writer};
use crate::labels;
use crate::render::{Renderer, Samples, Scene, planes};

/// Exposures whose samples wait for their planes.
const QUEUE: usize = 1;

/// Where the time of the images went, each stage on its own thread.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spent {
    pub samples: Duration,
    /// Planes, maps and records.
    pub planes: Duration,
    /// Of the device, where it can tell.
    pub device: Duration,
}

/// Renders the exposures `todo` and hands them to `writer`.
pub fn render(
    prepared: &Prepared,
    scene: &mut Scene,
    run: &dataset::Run,
    renderer: &mut dyn Renderer,
    writer: &mut Writer,
    todo: &[usize],
    progress: &dyn Progress,
) -> Result<Spent, Error> {
    // A sweep changes the reflectance for the renderer while the other thread makes planes, which do not depend on it.
    let scene = RwLock::new(scene);
    std::thread::scope(|scope| {
        let (sender, receiver) = sync_channel::<(usize, Samples)>(QUEUE);
        let finisher = scope.spawn(|| {
            let mut spent = Duration::ZERO;
            for (index, samples) in receiver {
                let start = Instant::now();
                let exposure = {
                    let scene = scene.read().unwrap_or_else(PoisonError::into_inner);
                    exposure(prepared, &scene, run, index, &samples)?
                };
                drop(samples);
                spent += start.elapsed();
                writer.submit(exposure)?;
            }
            Ok::<_, Error>(spent)
        });
        let mut spent = Spent::default();
        let mut samples = |index: usize| {
            let exposure = &prepared.exposures[index];
            let reflectance = scene::reflectance(&prepared.points[exposure.point])?;
            let changes = scene.read().unwrap_or_else(PoisonError::into_inner).reflectance != reflectance;
            if changes {
                scene.write().unwrap_or_else(PoisonError::into_inner).reflectance = reflectance;
            }
            let start = Instant::now();
            let samples = renderer.samples(&scene.read().unwrap_or_else(PoisonError::into_inner), &exposure.view)?;
            spent.samples += start.elapsed();
            spent.device += renderer.device_time().unwrap_or_default();
            Ok::<_, Error>(samples)
        };
        let mut rendered = Ok(());
        for (count, &index) in todo.iter().enumerate() {
            let sent = match samples(index) {
                Ok(samples) => sender.send((index, samples)),
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
        rendered.map(|()| spent)
    })
}

/// All that is written of an exposure.
fn exposure(
    prepared: &Prepared,
    scene: &Scene,
    run: &dataset::Run,
    index: usize,
    samples: &Samples,
) -> Result<dataset::Exposure, Error> {
    let exposure = &prepared.exposures[index];
    let point = &prepared.points[exposure.point];
    let detector = scene::detector(point)?;
    let image = planes::image_with(scene, detector.as_ref(), &exposure.view, samples);
    let facts = record::facts(prepared, scene, run, index, &image);
    let wanted = point.outputs.formats.contains(&Format::GeoTiff);
    let orthoimage = wanted.then(|| ortho::orthoimage(scene, prepared.ground.centre, &exposure.view, &image));
    let landmarks = point
        .landmarks
        .as_ref()
        .map(|wanted| labels::landmarks(scene, &exposure.view, &prepared.craters, wanted.smallest_px));
    Ok(dataset::Exposure { index, image, facts, landmarks, orthoimage: orthoimage.transpose()?.flatten() })
}
