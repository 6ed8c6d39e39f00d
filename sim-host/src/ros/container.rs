//! The container of a bag, MCAP: records, one after the other, some of them packed in chunks.
//!
//! Every length is checked against what is left before anything is made of it, and every checksum before anything is given away: bags come from disks that
//! fill up and from lines that flip bits.

use mcap::MAGIC;
use mcap::records::op;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Read as _;

/// Why a bag ends before its end.
type Damage = String;

/// What messages come by.
#[derive(PartialEq, Eq)]
pub struct Channel {
    /// Its name.
    pub topic: String,
    /// The type of its messages; empty if it has none.
    pub kind: String,
    /// Their encoding.
    pub encoding: String,
}

/// Gives each message of a bag: its channel, its time \[ns\], its bytes.
///
/// # Errors
/// Why it is not read to its end. What was given until then is good.
pub fn read(bytes: &[u8], mut each: impl FnMut(&Channel, u64, &[u8])) -> Result<(), Damage> {
    let records = bytes.strip_prefix(MAGIC);
    let mut rest = Rest(records.ok_or("it does not begin as MCAP does")?);
    let mut known = Known::default();
    let mut ended = false;
    loop {
        let at = bytes.len() - rest.0.len();
        let damage = |why: Damage| format!("damaged or cut off at byte {at}: {why}");
        let (opcode, body) = rest.record().map_err(damage)?;
        match opcode {
            op::DATA_END => {
                let stated = Rest(body).u32().map_err(damage)?;
                checksum(stated, bytes.get(..at).unwrap_or_default()).map_err(damage)?;
                ended = true;
            }
            op::FOOTER if rest.0.starts_with(MAGIC) => return Ok(()),
            op::FOOTER => return Err(damage("it does not end as MCAP does".to_owned())),
            // Behind its data a bag repeats what is in it, for those who seek.
            _ if ended => {}
            op::CHUNK => {
                let records = unpacked(body).map_err(damage)?;
                let mut records = Rest(&records);
                while !records.0.is_empty() {
                    let (opcode, body) = records.record().map_err(damage)?;
                    known.take(opcode, body, &mut each).map_err(damage)?;
                }
            }
            _ => known.take(opcode, body, &mut each).map_err(damage)?,
        }
    }
}

/// The records of a chunk.
fn unpacked(body: &[u8]) -> Result<Cow<'_, [u8]>, Damage> {
    let mut rest = Rest(body);
    // The times of its first and last message.
    rest.take(16)?;
    let (size, stated) = (rest.u64()?, rest.u32()?);
    let packing = rest.text()?;
    let packed = rest.u64()?;
    let packed = rest.take(packed)?;
    let records = match packing {
        "" => Cow::Borrowed(packed),
        "zstd" => {
            // Grows by what is there, whatever size is stated.
            let mut records = Vec::new();
            zstd::Decoder::with_buffer(packed)
                .and_then(|decoder| decoder.take(size).read_to_end(&mut records))
                .map_err(|error| format!("a chunk that cannot be unpacked: {error}"))?;
            Cow::Owned(records)
        }
        _ => return Err(format!("a chunk packed by {packing:?}, which is not known")),
    };
    if records.len() as u64 != size {
        return Err(format!(
            "a chunk of {} bytes that states {size}",
            records.len()
        ));
    }
    checksum(stated, &records)?;
    Ok(records)
}

/// 0 states none.
fn checksum(stated: u32, bytes: &[u8]) -> Result<(), Damage> {
    match stated == 0 || stated == crc32fast::hash(bytes) {
        true => Ok(()),
        false => Err("a checksum that does not fit".to_owned()),
    }
}

/// What was defined so far.
#[derive(Default)]
struct Known {
    /// Names of types.
    schemas: BTreeMap<u64, String>,
    channels: BTreeMap<u64, Channel>,
}

impl Known {
    fn take(
        &mut self,
        opcode: u8,
        body: &[u8],
        each: &mut impl FnMut(&Channel, u64, &[u8]),
    ) -> Result<(), Damage> {
        let mut rest = Rest(body);
        match opcode {
            op::SCHEMA => {
                let id = rest.u16()?;
                define(&mut self.schemas, id, rest.text()?.to_owned())
            }
            op::CHANNEL => {
                let (id, schema) = (rest.u16()?, rest.u16()?);
                let kind = match (schema, self.schemas.get(&schema)) {
                    (0, _) => String::new(),
                    (_, Some(kind)) => kind.clone(),
                    (_, None) => return Err(format!("no type {schema}")),
                };
                let channel = Channel {
                    topic: rest.text()?.to_owned(),
                    kind,
                    encoding: rest.text()?.to_owned(),
                };
                define(&mut self.channels, id, channel)
            }
            op::MESSAGE => {
                let id = rest.u16()?;
                // Its number.
                rest.take(4)?;
                let log_ns = rest.u64()?;
                // The time at which it was published.
                rest.take(8)?;
                let channel = self.channels.get(&id);
                each(
                    channel.ok_or_else(|| format!("no channel {id}"))?,
                    log_ns,
                    rest.0,
                );
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

/// May be repeated, but not as something else.
fn define<T: PartialEq>(known: &mut BTreeMap<u64, T>, id: u64, new: T) -> Result<(), Damage> {
    match known.get(&id) {
        Some(old) if *old != new => Err(format!("{id} is defined as two things")),
        _ => {
            known.insert(id, new);
            Ok(())
        }
    }
}

/// Bytes not read so far.
struct Rest<'a>(&'a [u8]);

impl<'a> Rest<'a> {
    fn take(&mut self, count: u64) -> Result<&'a [u8], Damage> {
        let taken = usize::try_from(count).ok();
        let taken = taken.and_then(|count| self.0.split_at_checked(count));
        let left = self.0.len();
        let (taken, rest) = taken.ok_or_else(|| format!("{count} bytes stated, {left} there"))?;
        self.0 = rest;
        Ok(taken)
    }

    /// Little-endian, of so many bytes.
    fn number(&mut self, bytes: u64) -> Result<u64, Damage> {
        let bytes = self.take(bytes)?.iter().rev();
        Ok(bytes.fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }

    fn u16(&mut self) -> Result<u64, Damage> {
        self.number(2)
    }

    fn u32(&mut self) -> Result<u32, Damage> {
        self.number(4).map(|number| number as u32)
    }

    fn u64(&mut self) -> Result<u64, Damage> {
        self.number(8)
    }

    fn text(&mut self) -> Result<&'a str, Damage> {
        let length = self.u32()?;
        let text = self.take(u64::from(length))?;
        std::str::from_utf8(text).map_err(|_| "a name that is no UTF-8".to_owned())
    }

    fn record(&mut self) -> Result<(u8, &'a [u8]), Damage> {
        let opcode = self.number(1)?;
        let length = self.u64()?;
        Ok((opcode as u8, self.take(length)?))
    }
}
