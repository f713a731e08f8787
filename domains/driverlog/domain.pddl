; Packages, trucks and their drivers, who walk on paths and drive on links: predicates and actions
; of the competitions' domain of this name, without types as there.
(define (domain driverlog)
  (:requirements :strips)
  (:predicates
    (obj ?o) (truck ?t) (location ?l) (driver ?d)
    (at ?x ?l) (in ?o ?t) (driving ?d ?t) (link ?x ?y) (path ?x ?y) (empty ?t))
  (:action load-truck
    :parameters (?o ?t ?l)
    :precondition (and (obj ?o) (truck ?t) (location ?l) (at ?t ?l) (at ?o ?l))
    :effect (and (not (at ?o ?l)) (in ?o ?t)))
  (:action unload-truck
    :parameters (?o ?t ?l)
    :precondition (and (obj ?o) (truck ?t) (location ?l) (at ?t ?l) (in ?o ?t))
    :effect (and (not (in ?o ?t)) (at ?o ?l)))
  (:action board-truck
    :parameters (?d ?t ?l)
    :precondition (and (driver ?d) (truck ?t) (location ?l) (at ?t ?l) (at ?d ?l) (empty ?t))
    :effect (and (not (at ?d ?l)) (driving ?d ?t) (not (empty ?t))))
  (:action disembark-truck
    :parameters (?d ?t ?l)
    :precondition (and (driver ?d) (truck ?t) (location ?l) (at ?t ?l) (driving ?d ?t))
    :effect (and (not (driving ?d ?t)) (at ?d ?l) (empty ?t)))
  (:action drive-truck
    :parameters (?t ?from ?to ?d)
    :precondition (and (truck ?t) (location ?from) (location ?to) (driver ?d)
                       (at ?t ?from) (driving ?d ?t) (link ?from ?to))
    :effect (and (not (at ?t ?from)) (at ?t ?to)))
  (:action walk
    :parameters (?d ?from ?to)
    :precondition (and (driver ?d) (location ?from) (location ?to) (at ?d ?from) (path ?from ?to))
    :effect (and (not (at ?d ?from)) (at ?d ?to))))
