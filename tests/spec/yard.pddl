(define (domain yard)
  (:requirements :typing)
  (:types block place)
  (:constants depot - place)
  (:predicates (on ?x ?y - block) (clear ?x - block) (at ?x - block ?p - place)
               (road ?p ?q - place) (in ?x - block) (sent ?x - block ?p - place ?q - place))
  (:action take
    :parameters (?x ?y - block)
    :precondition (and (on ?x ?y) (clear ?x))
    :effect (and (not (on ?x ?y)) (clear ?y)))
  (:action send
    :parameters (?x - block ?p ?q - place)
    :precondition (and (at ?x ?p) (road ?p ?q) (clear ?x))
    :effect (and (not (at ?x ?p)) (at ?x ?q) (sent ?x ?p ?q))))
