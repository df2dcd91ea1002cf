//! What a run that is stopped hands over.

use surfometry::Control;
use surfometry::runs::{Batch, Collected, Item, Opened, RunError, Task};

/// The first input ends by the stop alone, which the second asks for when it is done.
struct SecondFirst;

impl Task for SecondFirst {
    type Row = String;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<String>)) -> Result<(), RunError> {
        if input.name.contains("radius=4") {
            loop {
                input.control.check()?;
                std::thread::yield_now();
            }
        }
        out(Item::Row(input.name.to_owned()));
        input.control.stop();
        Ok(())
    }
}

/// What was finished behind an input that was not is handed over.
#[test]
fn what_was_finished_is_handed_over() {
    let inputs = [4, 5].map(|radius| format!("phantom:ball?radius={radius}"));
    let control = Control::default();
    let batch = Batch {
        inputs: &inputs,
        open: surfometry::inputs::OpenOptions::default(),
        control: &control,
        cure: |_| None,
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let mut found = Collected::default();
    let outcome = pool.install(|| batch.run(&SecondFirst, &mut found)).unwrap();
    assert!(outcome.stopped);
    assert_eq!((outcome.rows, found.results), (1, vec![inputs[1].clone()]));
}
