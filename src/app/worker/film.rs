//! A film, one picture at a time: all other orders are carried out between two pictures.

use super::WorkerState;
use crate::app::news::News;
use crate::app::queue::{Inbox, Order};
use crate::ask::{Answer, Ask, FilmOf, FilmSubject, Filmed, PendingQuestion, RunRequest};
use crate::film::{Film, FilmContent, FilmMotion, LightRound, PLACES};
use crate::picture::apng::ColorDepth;
use crate::session::CaptureRequest;
use std::path::Path;
use std::sync::Arc;

/// The film that is being written.
pub(super) struct FilmRun {
    ticket: u64,
    film: Film,
}

impl WorkerState {
    /// Writes the next picture of the film that is asked for, and puts the question back while there are more; reports
    /// the answer once the film is complete or has failed.
    pub(super) async fn film_turn(&mut self, of: [u64; 2], asked: PendingQuestion, inbox: &mut Inbox) {
        let had_session = self.session.is_some();
        let result = self.next_picture(of, &asked).await;
        if self.session.is_some() != had_session {
            (self.notify)(News::Idle);
        }
        let result = match result {
            Ok(None) => return inbox.queue.restore_waiting(Order::Answer { scene: of[0], frame: of[1], asked }),
            Ok(Some(filmed)) => Ok(Answer::FilmOf(Arc::new(filmed))),
            Err(reason) => Err(reason),
        };
        (self.notify)(News::Answered { ticket: asked.ticket, result });
    }

    /// Writes the film's next picture, and returns `None` while the film is not complete; returns the finished film in
    /// the call after its last picture. A film of another question that is being written is dropped, and one that fails
    /// is deleted.
    async fn next_picture(&mut self, of: [u64; 2], asked: &PendingQuestion) -> Result<Option<Filmed>, String> {
        let before = self.film.take();
        let mut run = match (before, &asked.ask) {
            (Some(run), _) if run.ticket == asked.ticket => run,
            (_, Ask::FilmOf(question)) => {
                let film = self.begin_film(of, question)?;
                asked.progress.start(film.pictures() as usize);
                FilmRun { ticket: asked.ticket, film }
            }
            _ => return Err("it is no film".to_owned()),
        };
        let is_more = run.film.shoot(async |scene, request| self.session().await?.capture(scene, request).await).await;
        if is_more.map_err(|error| error.to_string())? {
            asked.progress.advance();
            self.film = Some(run);
            return Ok(None);
        }
        let pictures = run.film.pictures();
        let bytes = run.film.finish().map_err(|error| error.to_string())?;
        Ok(Some(Filmed { pictures, bytes }))
    }

    fn begin_film(&self, of: [u64; 2], question: &FilmOf) -> Result<Film, String> {
        let shows = match &question.subject {
            FilmSubject::Steps(sides) => FilmContent::Steps(sides.clone()),
            FilmSubject::LightRound { sides, light } => {
                let open = self.open.as_ref().filter(|_| of[0] == self.scenes);
                let open = open.ok_or("another scene is open by now: export it again")?;
                // The sides differ in technique and settings alone.
                let request = sides.first().ok_or("nothing is to be shown: export it again")?;
                let scene = request.applied_to(open).advanced(request.time);
                let round = LightRound::new(scene, *light, PLACES).map_err(|error| error.to_string())?;
                let of_side = |side: &RunRequest| CaptureRequest::new(side.choice.clone(), side.size);
                FilmContent::Moving {
                    motion: Box::new(FilmMotion::LightRound(round)),
                    sides: sides.iter().map(of_side).collect(),
                    has_captions: true,
                    colors: ColorDepth::Rounded,
                }
            }
        };
        let milliseconds = shows.milliseconds();
        let film = Film::begin(shows, Path::new(&question.path), milliseconds).map_err(|error| error.to_string())?;
        Ok(film.marking(question.pick))
    }
}
