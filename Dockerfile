# docker build -t faying . && docker run --rm -v "$PWD:/work" faying run hertz.toml
FROM rust:1-slim-bookworm AS build
WORKDIR /src
COPY . .
RUN cargo install --locked --path crates/faying-cli --root /out

FROM debian:bookworm-slim
COPY --from=build /out/bin/faying /usr/local/bin/
WORKDIR /work
ENTRYPOINT ["faying"]
