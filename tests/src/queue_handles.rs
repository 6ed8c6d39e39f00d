// Not a module: `panic_link` makes a program of it. Every public function of every handle of a queue, each for itself: a
// pointer to it goes where the compiler does not look, so that nothing is known about its arguments.

use controller_core::maths::Single;
use controller_core::queue::{Gap, PushError, ReferenceConsumer, ReferenceProducer, ReferenceQueue, TimedReference};
use controller_core::reference::Reference;
use protocol::{Command, Frame, Telemetry};
use firmware_demo::queue::{Receiver, Sender, split};
use firmware_demo::control_server::{Queues, CommandReceiver};
use firmware_demo::telemetry::TelemetryQueue;
use heapless::spsc::Queue;

fn split_of<T, const N: usize>(q: &'static mut Queue<T, N>) -> (Sender<'static, T, N>, Receiver<'static, T, N>) { split(q) }
fn send<T, const N: usize>(s: &mut Sender<'static, T, N>, v: T) -> bool { s.send(v) }
fn receive<T, const N: usize>(r: &mut Receiver<'static, T, N>) -> Option<T> { r.receive() }
fn handles<T: 'static, const N: usize>() {
    black_box(split_of::<T, N> as fn(_) -> _);
    black_box(send::<T, N> as fn(_, _) -> _);
    black_box(receive::<T, N> as fn(_) -> _);
}
fn offer(o: &mut TelemetryQueue<'static, u32, 4>, v: u32) { o.offer(|| v) }
fn push_out(o: &mut TelemetryQueue<'static, u32, 4>, v: u32) -> bool { o.push(v) }
fn osplit(q: &'static mut Queue<u32, 4>, every: u16) -> (TelemetryQueue<'static, u32, 4>, Receiver<'static, u32, 4>) { TelemetryQueue::split(q, every) }

fn rsplit<const N: usize>(q: &'static mut ReferenceQueue<f32, N>) -> (ReferenceProducer<'static, f32>, ReferenceConsumer<'static, f32>) { q.split() }
fn push(p: &mut ReferenceProducer<'static, f32>, s: TimedReference<f32>) -> Result<(), PushError> { p.push(s) }
fn room(p: &ReferenceProducer<'static, f32>) -> usize { p.room() }
fn restart(p: &mut ReferenceProducer<'static, f32>) { p.restart() }
fn at(c: &mut ReferenceConsumer<'static, f32>, t: f32) -> Result<Reference<f32>, Gap<f32>> { c.at::<Single>(t) }
fn end(c: &ReferenceConsumer<'static, f32>) -> Option<(TimedReference<f32>, TimedReference<f32>)> { c.end() }
fn waiting(c: &ReferenceConsumer<'static, f32>) -> usize { c.waiting() }
fn clear(c: &mut ReferenceConsumer<'static, f32>) { c.clear() }
fn hear(r: &mut CommandReceiver<'static>, b: u8) -> Option<Frame<Telemetry>> { r.push(b, || 0) }
fn pending(r: &mut CommandReceiver<'static>) -> Option<Frame<Telemetry>> { r.pending() }
fn run() {
    handles::<u8, 2>();
    handles::<u32, 4>();
    handles::<u32, 5>();
    handles::<u32, 64>();
    handles::<Frame<Command>, 8>();
    handles::<Frame<Telemetry>, 16>();
    handles::<[u8; 300], 3>();
    black_box(offer as fn(_, _));
    black_box(push_out as fn(_, _) -> _);
    black_box(osplit as fn(_, _) -> _);
    black_box(rsplit::<2> as fn(_) -> _);
    black_box(rsplit::<64> as fn(_) -> _);
    black_box(push as fn(_, _) -> _);
    black_box(room as fn(_) -> _);
    black_box(restart as fn(_));
    black_box(at as fn(_, _) -> _);
    black_box(end as fn(_) -> _);
    black_box(waiting as fn(_) -> _);
    black_box(clear as fn(_));
    black_box(hear as fn(_, _) -> _);
    black_box(pending as fn(_) -> _);
}
